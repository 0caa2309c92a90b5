// SPDX-License-Identifier: Apache-2.0
// Rough interfaces of stacks: energy, reciprocity, the smooth limit, and what microfacets reflect and pass,
// by integration over their normals. Path traced ones are in tests/medium.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "aureole/optics/interface/fresnel_equations.h"
#include "optics/stack/stack_test_support.h"

namespace aureole::optics {
namespace {

using testing::hg_layer;
using testing::slide;

StackDescription rough_slab(const StackInterface& interface, double albedo = 1) {
  StackDescription d;
  d.layers = {hg_layer(3, albedo, 0.5, 1.5)};
  d.layers[0].top = d.bottom = interface;
  return d;
}

TEST(RoughInterface, EnergyAndReciprocity) {
  for (const StackInterface& interface : {StackInterface{InterfaceKind::ggx, 0.05},
                                          {InterfaceKind::ggx, 0.4},
                                          {InterfaceKind::beckmann, 0.2},
                                          {InterfaceKind::beckmann, 1}}) {
    const PlaneStack stack(rough_slab(interface), {16});
    const StackLight lights[] = {StackLight::beam(1), StackLight::beam(0.1), StackLight::beam(0.6, true),
                                 StackLight::diffuse()};
    for (const StackFluxes& f : stack.fluxes(lights)) {
      EXPECT_NEAR(f.absorptance(), 0, 1e-10);
      EXPECT_EQ(f.unscattered_transmittance, 0);
    }
    const StackLight beams[] = {StackLight::beam(0.5), StackLight::beam(0.9)};
    const double cosines[] = {0.5, 0.9}, azimuths[] = {0.4};
    const auto radiance = stack.radiance(beams, cosines, azimuths);
    EXPECT_NEAR(radiance[1] / radiance[2], 1, 1e-10);
  }
}

TEST(RoughInterface, IsNearlySmoothWhereRoughnessIsSmall) {
  const StackLight lights[] = {StackLight::beam(0.9), StackLight::diffuse()};
  const auto smooth = PlaneStack(rough_slab({}, 0.9), {64}).fluxes(lights);
  const auto rough = PlaneStack(rough_slab({InterfaceKind::beckmann, 0.05}, 0.9), {64}).fluxes(lights);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(rough[i].reflectance, smooth[i].reflectance, 3e-3);
    EXPECT_NEAR(rough[i].transmittance, smooth[i].transmittance, 3e-3);
  }
}

struct Albedo {
  double reflected, passed;
};

/// Reflection and refraction by Beckmann's or GGX's facets of index 1.5 of light at this cosine, met once:
/// integral over the normals that it sees, in slopes.
Albedo single_scattering(const StackInterface& interface, double mu) {
  const auto unmasked = [&](double c) {
    const double t = interface.alpha * std::sqrt(1 - c * c) / c, a = 1 / t;
    if (t < 1e-9) return 1.0;
    // Smith's lambda by the distribution of slopes.
    const double lambda =
        interface.kind == InterfaceKind::ggx
            ? 0.5 * (std::sqrt(1 + t * t) - 1)
            : 0.5 * (std::erf(a) - 1 + std::exp(-a * a) / (a * std::sqrt(std::numbers::pi)));
    return 1 / (1 + lambda);
  };
  Albedo sum{0, 0};
  const int radii = 600, turns = 120;
  for (int i = 0; i < radii; ++i) {
    // Slopes with equal probability: their radius by inversion of the cumulative distribution.
    const double u = (i + 0.5) / radii;
    const double slope =
        interface.alpha * std::sqrt(interface.kind == InterfaceKind::ggx ? u / (1 - u) : -std::log(1 - u));
    const double cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
    for (int k = 0; k < turns; ++k) {
      const double phi = 2 * std::numbers::pi * (k + 0.5) / turns;
      const double dot = cosine * mu + sine * std::cos(phi) * std::sqrt(1 - mu * mu);
      if (!(dot > 0)) continue;
      const double weight = dot / (mu * cosine) * unmasked(mu) / (radii * turns);
      const double f = fresnel_reflectance(dot, 1, 1.5);
      const double reflected = 2 * dot * cosine - mu;
      if (reflected > 0) sum.reflected += weight * f * unmasked(reflected);
      const double cos_t = std::sqrt(1 - (1 - dot * dot) / 2.25);
      const double refracted = mu / 1.5 + cosine * (cos_t - dot / 1.5);
      if (refracted > 0) sum.passed += weight * (1 - f) * unmasked(refracted);
    }
  }
  return sum;
}

TEST(RoughInterface, AlbedoOfMicrofacets) {
  for (const StackInterface& interface : {StackInterface{InterfaceKind::ggx, 0.1},
                                          {InterfaceKind::ggx, 0.5},
                                          {InterfaceKind::beckmann, 0.15},
                                          {InterfaceKind::beckmann, 0.5}})
    for (const double mu : {1.0, 0.5, 0.2}) {
      StackDescription d;
      d.layers = {slide(1.5)};
      d.layers[0].top = interface;
      d.index_below = 1.5;
      const StackFluxes f = PlaneStack(d, {64}).fluxes(StackLight::beam(mu));
      const Albedo once = single_scattering(interface, mu);
      const double missing = 1 - once.reflected - once.passed;
      std::printf(
          "%s %.2f, cosine %.1f: R %.4f and T %.4f of facets met once, %.4f and %.4f of the interface\n",
          interface.kind == InterfaceKind::ggx ? "GGX" : "Beckmann", interface.alpha, mu, once.reflected,
          once.passed, f.reflectance, f.transmittance);
      EXPECT_GT(f.reflectance, once.reflected - 0.004);
      EXPECT_LT(f.reflectance, once.reflected + missing + 0.004);
      EXPECT_GT(f.transmittance, once.passed - 0.004);
    }
}

}  // namespace
}  // namespace aureole::optics
