// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/coherent_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;

TEST(CoherentLayer, IsThePublishedFormula) {
  for (const double x : {0.5, 4.0, 30.0, 200.0})
    for (const Complex m : {Complex(1.33), Complex(1.6, 0.05)})
      for (const double cos_i : {0.03, 0.4, 0.9, 1.0})
        for (const double fa : {0.01, 0.3, 0.7}) {
          const Mie sphere(x, m);
          const CoherentLayer layer = coherent_layer(cos_i, fa, sphere);
          const double theta = std::acos(cos_i);
          const MieAmplitudes s = sphere.amplitudes(std::cos(M_PI - 2 * theta));
          const double alpha = 2 * fa / (x * x * cos_i);
          const Complex s0 = sphere.forward();
          for (int j = 0; j < 2; ++j) {
            const Complex sj = j == 0 ? s.s1 : s.s2;
            const Complex rest = alpha * alpha / 4 * (s0 * s0 - sj * sj), d = 1.0 + alpha * s0 + rest;
            EXPECT_LT(std::abs(layer.reflection[j] + alpha * sj / d), 1e-9);
            EXPECT_LT(std::abs(layer.transmission[j] - (1.0 - rest) / d), 1e-9);
          }
          const double all = (std::norm(layer.transmission[0]) + std::norm(layer.transmission[1]) +
                              std::norm(layer.reflection[0]) + std::norm(layer.reflection[1])) /
                             2;
          EXPECT_NEAR(layer.transmittance() + layer.reflectance(), all, 1e-14);
        }
}

TEST(CoherentLayer, NeverGainsEnergy) {
  // Every polarisation alone, from Rayleigh scatterers over resonances to large spheres.
  double most = 0;
  for (const double n : {0.3, 0.75, 1.1, 1.33, 1.5, 2.0, 4.0})
    for (const double k : {0.0, 0.01, 3.0})
      for (double x = 0.01; x < 200; x *= 1.07) {
        const Mie sphere(x, {n, k});
        for (int i = 1; i <= 40; ++i) {
          const double cos_i = i * i / 1600.0;
          const MieAmplitudes s = sphere.amplitudes(1 - 2 * cos_i * cos_i);
          for (const double fa : {0.05, 0.3, 0.7}) {
            const CoherentLayer layer = coherent_layer(cos_i, fa, {x * x, sphere.forward()}, s);
            for (int j = 0; j < 2; ++j)
              most = std::max(most, std::norm(layer.transmission[j]) + std::norm(layer.reflection[j]));
          }
        }
      }
  EXPECT_LE(most, 1 + 1e-12);
  EXPECT_GT(most, 0.999);
}

TEST(CoherentLayer, SmallCoverageIsExtinction) {
  for (const double x : {0.3, 3.0, 50.0, 400.0})
    for (const Complex m : {Complex(1.33), Complex(1.5, 0.1)})
      for (const double cos_i : {0.2, 0.7, 1.0}) {
        const Mie sphere(x, m);
        const double fa = 1e-5;
        const double lost = 1 - coherent_layer(cos_i, fa, sphere).transmittance();
        EXPECT_NEAR(lost / (fa * sphere.extinction() / cos_i), 1, 3e-3) << x << m << cos_i;
      }
}

TEST(CoherentLayer, LargeSpheres) {
  // |t|^2 = ((1 - g)/(1 + g))^2 with g = Fa/(2 cos_i), up to x^(-2/3); Babinet's (1 - Fa)^2 is less.
  for (const double fa : {0.1, 0.3, 0.5, 0.7})
    for (const double cos_i : {0.3, 0.6, 1.0}) {
      const Mie sphere(2e4, {1.5, 0.1});
      const double g = fa / (2 * cos_i), t = (1 - g) / (1 + g);
      EXPECT_NEAR(coherent_layer(cos_i, fa, sphere).transmittance(), t * t, 4e-3) << fa << " " << cos_i;
    }
  EXPECT_NEAR(coherent_layer(1, 0.5, Mie(2e4, {1.5, 0.1})).transmittance(), 0.36, 2e-3);
}

TEST(CoherentLayer, Limits) {
  const Mie sphere(12, 1.33);
  const CoherentLayer grazing = coherent_layer(0, 0.3, sphere), empty = coherent_layer(0.5, 0, sphere);
  EXPECT_EQ(grazing.reflectance(), 1);
  EXPECT_EQ(grazing.transmittance(), 0);
  EXPECT_EQ(grazing.loss(), 0);
  EXPECT_EQ(empty.transmittance(), 1);
  EXPECT_EQ(empty.loss(), 0);
  // Continuous towards grazing light.
  EXPECT_NEAR(coherent_layer(1e-5, 0.3, sphere).reflectance(), 1, 1e-3);
  // Without contrast nothing happens.
  EXPECT_NEAR(coherent_layer(0.5, 0.3, Mie(12, 1)).transmittance(), 1, 1e-12);
  for (const double wrong : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(coherent_layer(wrong, 0.3, sphere), std::domain_error);
    EXPECT_THROW(coherent_layer(0.5, wrong, sphere), std::domain_error);
  }
}

}  // namespace
}  // namespace aureole::optics
