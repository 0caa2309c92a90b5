// SPDX-License-Identifier: Apache-2.0
// BSSRDFs against transport: where a thin beam lights a half-space, how far from it does light leave? The
// differences are those of the models; the test prints them (docs/subsurface.md) and holds them within
// bounds.
//
// AUREOLE_THOROUGH=1 follows 200,000 photons per case.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "aureole/bssrdf/bssrdf.h"
#include "aureole/optics/medium/half_space.h"
#include "bssrdf/half_space_photons.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

std::string parameter(const std::string& name, double v) {
  return "<float name=\"" + name + "\" value=\"" + std::to_string(v) + "\"/>";
}

std::shared_ptr<Bssrdf> model_of(const HalfSpace& h, const std::string& type, const std::string& more = "") {
  return build<Bssrdf>("<bssrdf type=\"" + type + "\">" + parameter("sigma_t", 1) +
                       parameter("albedo", h.albedo) + parameter("g", h.g) + parameter("int_ior", h.index) +
                       parameter("ext_ior", 1) + more + "</bssrdf>");
}

/// The part of the light that leaves between two distances, by quadrature.
double leaving(const Bssrdf& model, double from, double to) {
  const Wavelengths w = Wavelengths::at(SpectralGrid{}, 550.f);
  const SurfacePoint point;
  constexpr int kSteps = 64;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = from + (to - from) * (i + 0.5) / kSteps;
    sum += double(model.eval_pdf(float(r), {w, point}).value[0]) * 2 * std::numbers::pi * r * (to - from) /
           kSteps;
  }
  return sum;
}

/// Ring by ring, in reduced mean free paths.
const std::vector<double> kEdges = {0, 0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32};

struct Difference {
  double all;    ///< of the light that leaves in all, relative
  double moved;  ///< part of the light that leaves in the wrong ring, half the sum of absolute differences
  std::vector<double> rings;  ///< relative difference per ring
};

Difference compare(const Bssrdf& model, const RadialProfile& truth) {
  Difference d{0, 0, {}};
  double model_total = 0;
  for (std::size_t i = 0; i + 1 < truth.radii.size(); ++i) {
    const double part = leaving(model, truth.radii[i], truth.radii[i + 1]);
    model_total += part;
    d.moved += std::abs(part - truth.leaves[i]) / 2 / truth.total();
    d.rings.push_back(part / truth.leaves[i] - 1);
  }
  d.all = model_total / (truth.total() - truth.beyond) - 1;
  return d;
}

void print(const char* name, const Difference& d) {
  std::printf("    %-20s all %+6.1f %%, misplaced %5.1f %%; rings", name, 100 * d.all, 100 * d.moved);
  for (const double ring : d.rings) std::printf(" %+5.0f", 100 * ring);
  std::printf("\n");
}

struct Bounds {
  HalfSpace half_space;
  double dipole, normalized;  ///< largest part of the light in the wrong ring
};

class BssrdfAgainstTransport : public ::testing::TestWithParam<Bounds> {};

TEST_P(BssrdfAgainstTransport, ProfileOfABeam) {
  const HalfSpace& h = GetParam().half_space;
  const std::size_t photons = test::effort<std::size_t>(15000, 200000);
  std::vector<double> edges = kEdges;
  for (double& r : edges) r *= h.reduced_mean_free_path();
  const RadialProfile truth = follow_photons(h, edges, photons);
  const Difference dipole = compare(*model_of(h, "dipole"), truth);
  const Difference normalized = compare(*model_of(h, "normalized_diffusion"), truth);
  std::printf("albedo %g, g %g, index %g: %.4f leaves; rings end at .125 .25 .5 1 2 4 8 16 32 l'\n", h.albedo,
              h.g, h.index, truth.total());
  print("dipole", dipole);
  print("  with single",
        compare(*model_of(h, "dipole", "<boolean name=\"single_scattering\" value=\"true\"/>"), truth));
  print("normalized_diffusion", normalized);
  EXPECT_LT(dipole.moved, GetParam().dipole);
  EXPECT_LT(normalized.moved, GetParam().normalized);
}

INSTANTIATE_TEST_SUITE_P(HalfSpaces, BssrdfAgainstTransport,
                         ::testing::Values(Bounds{{.9, 0, 1}, .22, .03}, Bounds{{.99, 0, 1}, .16, .035},
                                           Bounds{{.999, 0, 1}, .14, .075}, Bounds{{.9, 0, 1.5}, .29, .065},
                                           Bounds{{.99, 0, 1.5}, .14, .055},
                                           Bounds{{.999, 0, 1.5}, .105, .04}, Bounds{{.9, .8, 1}, .21, .24},
                                           Bounds{{.99, .8, 1}, .09, .145}, Bounds{{.999, .8, 1}, .07, .09},
                                           Bounds{{.9, .8, 1.5}, .64, .35}, Bounds{{.99, .8, 1.5}, .2, .15},
                                           Bounds{{.999, .8, 1.5}, .135, .09}),
                         [](const auto& info) { return "Case" + std::to_string(info.index + 1); });

/// The reference itself, against the theory of transport for isotropic scattering.
TEST(HalfSpacePhotons, LeaveAsTheTheoryOfTransportSays) {
  for (const HalfSpace& h : {HalfSpace{.9, 0, 1}, HalfSpace{.99, 0, 1.5}}) {
    constexpr std::size_t kPhotons = 50000;
    const RadialProfile found = follow_photons(h, {0, 1}, kPhotons, 7);
    const double expected = optics::half_space_reflectance(h.albedo, h.index, optics::Illumination::normal);
    EXPECT_NEAR(found.total(), expected, 4 * 0.5 / std::sqrt(double(kPhotons)));
  }
}

}  // namespace
}  // namespace aureole::testing
