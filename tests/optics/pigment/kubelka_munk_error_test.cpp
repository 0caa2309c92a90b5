// SPDX-License-Identifier: Apache-2.0
// How far Kubelka and Munk's theory is from transport. AUREOLE_THOROUGH=1 prints the map of docs/pigments.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "aureole/optics/stack/plane_stack.h"
#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"
#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {
namespace {

using optics::LegendrePhase;
using optics::StackLight;

double lightness(double y) { return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27; }

/// Lightness of a layer under diffuse light, by both theories. Thickness counts in 1/(sigma_s (1 - g)).
struct Lightness {
  double transport, two_fluxes;
  double error() const { return two_fluxes - transport; }

  Lightness(double albedo, double thickness, double g, double substrate, double index) {
    const double scattering = 1 / (1 - g), absorption = scattering * (1 - albedo) / albedo;
    optics::StackDescription d;
    d.layers = {{absorption, scattering, thickness, LegendrePhase::henyey_greenstein(g), index}};
    d.substrate = substrate;
    const double r = optics::PlaneStack(d, {32}).fluxes(StackLight::diffuse()).reflectance;
    const LayerTransfer t = layer(coefficients_of_transport(absorption, scattering, g), thickness);
    const Surface surface = smooth_surface(index, Geometry::diffuse_diffuse, Specular::included);
    transport = lightness(r);
    two_fluxes = lightness(outer_reflectance(surface, reflectance_over(t, substrate)));
  }
};

constexpr double kAlbedos[] = {0.5, 0.9, 0.99, 0.999}, kThicknesses[] = {0.1, 1, 10, 100},
                 kGs[] = {0, 0.5, 0.9};

TEST(KubelkaMunkError, IsSmallForThickWhiteLayersAlone) {
  for (const double index : {1.0, 1.5})
    for (const double g : kGs) {
      EXPECT_LT(std::abs(Lightness(0.999, 100, g, 0, index).error()), 1) << index << " " << g;
      EXPECT_LT(std::abs(Lightness(0.999, 10, g, 0.8, index).error()), 2) << index << " " << g;
      EXPECT_GT(std::abs(Lightness(0.9, 0.1, g, 0, index).error()), 2) << index << " " << g;
    }
}

TEST(KubelkaMunkError, Map) {
  double worst = 0;
  for (const double index : {1.0, 1.5})
    for (const double substrate : {0.0, 0.8})
      for (const double g : kGs) {
        if (std::getenv("AUREOLE_THOROUGH"))
          std::printf("index %.1f, over %.1f, g %.1f, L* by transport (error), thickness .1 1 10 100\n",
                      index, substrate, g);
        for (const double albedo : kAlbedos) {
          if (std::getenv("AUREOLE_THOROUGH")) std::printf("| %.3g | %.3g |", g, albedo);
          for (const double thickness : kThicknesses) {
            const Lightness l(albedo, thickness, g, substrate, index);
            worst = std::max(worst, std::abs(l.error()));
            if (std::getenv("AUREOLE_THOROUGH")) std::printf(" %.1f (%+.1f) |", l.transport, l.error());
          }
          if (std::getenv("AUREOLE_THOROUGH")) std::printf("\n");
        }
      }
  // The whole map: K and S by convention err by this much somewhere.
  EXPECT_LT(worst, 8);
  EXPECT_GT(worst, 3);
}

}  // namespace
}  // namespace aureole::pigment
