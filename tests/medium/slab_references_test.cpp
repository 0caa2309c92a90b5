// SPDX-License-Identifier: Apache-2.0
// Layers under an oblique beam, one and two of them, on nothing or on a Lambertian surface: fluxes, and radiance by direction,
// against discrete ordinates of PythonicDISORT (optics/stack/references).
//
// AUREOLE_THOROUGH=1 follows a million paths per number and prints what it finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "harness/rendered.h"
#include "medium/slab_scenes.h"
#include "optics/stack/references/references.h"

namespace aureole::testing {
namespace {

using optics::DisortReference;

std::string medium(const DisortReference::Layer& layer, double extinction, const std::string& name) {
  return "<medium type=\"homogeneous\" name=\"" + name + "\">" + parameter("sigma_t", extinction) +
         parameter("albedo", layer.albedo) + "<phase type=\"double_hg\">" + parameter("g_forward", layer.g1) +
         parameter("g_backward", layer.g2) + parameter("weight", layer.share) + "</phase></medium>";
}

/// The layers from the height 1 down to 0, in squares of this half width.
std::string layers(const DisortReference& r, double half) {
  const std::string none = "<bsdf type=\"null\"/>";
  double all = 0, height = 1;
  for (const auto& layer : r.layers) all += layer.optical_thickness;
  std::string scene, above;
  for (const auto& layer : r.layers) {
    scene += level(height, true, none + medium(layer, all, "interior") + above, half);
    above = medium(layer, all, "exterior");
    height -= layer.optical_thickness / all;
  }
  const std::string bottom =
      r.substrate > 0 ? "<bsdf type=\"diffuse\">" + parameter("reflectance", r.substrate) + "</bsdf>" : none;
  return scene + level(0, true, bottom + above, half);
}

std::string triple(const std::string& element, const std::string& name, double x, double y, double z) {
  return "<" + element + " name=\"" + name + "\" x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) +
         "\" z=\"" + std::to_string(z) + "\"/>";
}

/// Looks from a point at this distance along (x, y, z) to a place on the axis.
std::string meter(double height, double x, double y, double z, double distance) {
  return "<sensor type=\"radiancemeter\">" +
         triple("point", "origin", distance * x, distance * y, height + distance * z) +
         triple("vector", "direction", -x, -y, -z) + "</sensor>";
}

Picture measure(const std::string& meters, int count, int samples, const std::string& scene) {
  return render("<integrator type=\"path\"/><sensor type=\"batch\">" + meters +
                "<sampler type=\"sobol\"><integer name=\"sample_count\" value=\"" + std::to_string(samples) +
                "\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"" +
                std::to_string(count) +
                "\"/><integer name=\"height\" value=\"1\"/><rfilter type=\"box\"/></film></sensor>" + scene);
}

class SlabReference : public ::testing::TestWithParam<int> {
protected:
  const DisortReference& r = optics::kDisort[GetParam()];
};

/// By reciprocity: the sky above, or below, of radiance 1, seen at the angle of the beam.
TEST_P(SlabReference, FluxesOfAnObliqueBeam) {
  const double sine = std::sqrt(1 - r.cosine * r.cosine);
  const std::string sky = "<emitter type=\"constant\">" + parameter("radiance", 1) + "</emitter>";
  const std::string black = "<bsdf type=\"diffuse\">" + parameter("reflectance", 0) + "</bsdf>";
  const std::string lamp = "<emitter type=\"area\">" + parameter("radiance", 1) + "</emitter>";
  for (const bool above : {true, false}) {
    if (!above && r.substrate > 0) continue;
    const Picture p = measure(
        meter(1, sine, 0, r.cosine, 0.5), 1, is_thorough() ? 65536 : 2048,
        layers(r, 1) + level(-2, true, above ? black : black + lamp) + (above ? sky : "") + mirrors());
    const double expected = r.fluxes[above ? 0 : 1];
    if (is_thorough())
      std::printf("%s %.6f +- %.6f, DISORT %.6f (%+.2f standard errors)\n", above ? "R" : "T", p.all,
                  p.all_error, expected, (p.all - expected) / p.all_error);
    EXPECT_NEAR(p.all, expected, 4.5 * p.all_error);
    EXPECT_LT(p.all_error, 0.015);
  }
}

TEST_P(SlabReference, Radiance) {
  std::string meters;
  std::vector<double> expected;
  const auto add = [&](double height, double side, const double* radiance) {
    for (int c = 0; c < 5; ++c)
      for (int a = 0; a < 3; ++a) {
        const double mu = r.cosines[c], sine = std::sqrt(1 - mu * mu), phi = optics::kDisortAzimuths[a];
        meters += meter(height, sine * std::cos(phi), sine * std::sin(phi), side * mu, 0.5);
        expected.push_back(radiance[c * 3 + a]);
      }
  };
  add(1, 1, r.up);
  if (r.substrate == 0) add(0, -1, r.down);
  const std::string beam = "<emitter type=\"directional\">" +
                           triple("vector", "direction", std::sqrt(1 - r.cosine * r.cosine), 0, -r.cosine) +
                           parameter("irradiance", 1 / r.cosine) + "</emitter>";
  const int count = int(expected.size());
  const Picture p = measure(meters, count, is_thorough() ? 65536 : 256, layers(r, 60) + beam);

  // Each direction, and all of them together by their mean ratio, weighted by what is known of each.
  double weights = 0, ratios = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double z = (p.mean[i] - expected[i]) / p.error[i],
                 weight = expected[i] * expected[i] / (p.error[i] * p.error[i]);
    EXPECT_LT(std::abs(z), 6) << "direction " << i << ": " << p.mean[i] << " instead of " << expected[i];
    weights += weight, ratios += weight * p.mean[i] / expected[i], squares += z * z / count;
  }
  const double ratio = ratios / weights, error = 1 / std::sqrt(weights);
  if (is_thorough())
    std::printf("%d directions: mean square of z %.2f, mean ratio %.5f +- %.5f\n", count, squares, ratio,
                error);
  EXPECT_NEAR(ratio, 1, 4.5 * error);
  EXPECT_LT(error, 0.01);
}

// One layer; a thick one that scatters alike; two on a surface; forward and backward lobes.
INSTANTIATE_TEST_SUITE_P(Disort, SlabReference, ::testing::Values(0, 1, 2, 3));

}  // namespace
}  // namespace aureole::testing
