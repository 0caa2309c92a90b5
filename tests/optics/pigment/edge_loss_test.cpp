// SPDX-License-Identifier: Apache-2.0
// Light lost at the edge of an aperture against photons that are followed through a layer.
#include "aureole/pigment/edge_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace aureole::pigment {
namespace {

/// Photons that enter a disc, isotropically downwards as diffuse light does, and leave the layer above; each scattering
/// is isotropic. Below the layer is a black card, or a Lambertian one of `card`, with the layer's own index.
struct Counted {
  double wide = 0, within = 0;  ///< fraction that leaves above, anywhere and within the disc
};
Counted follow(double sigma_a, double sigma_s, double thickness, double card, double radius, int photons) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const double pi = std::acos(-1.0), sigma = sigma_a + sigma_s;
  Counted counted;
  for (int n = 0; n < photons; ++n) {
    const double r = radius * std::sqrt(unit(random)), around = 2 * pi * unit(random);
    double x = r * std::cos(around), y = r * std::sin(around), z = 0, mu = std::sqrt(unit(random)),
           phi = 2 * pi * unit(random), weight = 1;
    while (weight > 0) {
      const double s = -std::log(1 - unit(random)) / sigma, limit = mu > 0 ? (thickness - z) / mu : -z / mu;
      const double step = std::min(s, limit), across = step * std::sqrt(1 - mu * mu);
      x += across * std::cos(phi), y += across * std::sin(phi), z += step * mu;
      if (s < limit) {
        weight *= sigma_s / sigma;
        mu = 2 * unit(random) - 1;
      } else if (mu < 0) {
        counted.wide += weight;
        if (x * x + y * y < radius * radius) counted.within += weight;
        break;
      } else {
        weight *= card;
        mu = -std::sqrt(unit(random));
      }
      phi = 2 * pi * unit(random);
      if (weight < 1e-3) weight = unit(random) < 0.1 ? weight * 10 : 0;
    }
  }
  counted.wide /= photons, counted.within /= photons;
  return counted;
}

TEST(EdgeLoss, AgainstPhotons) {
  // Diffusion: the loss is right within a third where the disc is wide beside 1/S.
  const Surface none;
  for (const auto& [sigma_a, sigma_s, thickness, card, radius] :
       {std::tuple{0.02, 1.0, 10.0, 0.0, 20.0}, {0.2, 1.0, 50.0, 0.0, 10.0}, {0.05, 1.0, 3.0, 0.8, 15.0}}) {
    const Counted counted = follow(sigma_a, sigma_s, thickness, card, radius, 200000);
    const Coefficients c{2 * sigma_a, 0.75 * sigma_s};
    const double wide = disc_reflectance(c, thickness, card, none, 1e6 * radius),
                 seen = disc_reflectance(c, thickness, card, none, radius);
    const double lost = (wide - seen) / wide, expected = (counted.wide - counted.within) / counted.wide;
    EXPECT_GT(expected, 0.02);
    EXPECT_NEAR(lost, expected, 0.33 * expected) << sigma_a << " " << thickness;
  }
}

TEST(EdgeLoss, Limits) {
  const Surface binder = smooth_surface(1.5, Geometry::diffuse_8, Specular::excluded);
  const double infinity = std::numeric_limits<double>::infinity();
  const Coefficients c{2e3, 8e4};
  const double wide = outer_reflectance(binder, reflectance_over(layer(c, 3e-5), 0.7));
  EXPECT_NEAR(disc_reflectance(c, 3e-5, 0.7, binder, 10), wide, 1e-5);
  // Nothing comes back to a disc much smaller than the mean free path but the gloss, which is excluded.
  EXPECT_LT(disc_reflectance(c, infinity, 0, binder, 1e-9), 0.01 * wide);
  double last = 0;
  for (double radius = 1e-5; radius < 1e-2; radius *= 2) {
    const double seen = disc_reflectance(c, 3e-5, 0.7, binder, radius);
    EXPECT_GT(seen, last);
    last = seen;
  }
  // A clear layer spreads nothing by scattering.
  EXPECT_NEAR(disc_reflectance({0, 0}, 1e-5, 0.5, binder, 1e-3), outer_reflectance(binder, 0.5), 1e-12);
  EXPECT_THROW(disc_reflectance(c, infinity, 0, binder, 0), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment
