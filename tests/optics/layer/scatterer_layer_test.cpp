// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/scatterer_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

/// |F|^2/|F(0)|^2 S' written out anew with the Bessel functions of the standard library.
double reference_intensity(double u, double ratio, double fa) {
  const auto airy = [](double x) { return x < 1e-6 ? 1.0 : 2 * std::cyl_bessel_j(1.0, x) / x; };
  const double f = fa / (1 - fa), a1 = airy(u);
  const double c =
      4 * f * airy(2 * u) + 4 * f * f * std::cyl_bessel_j(0.0, u) * a1 + (f * f + 2 * f * f * f) * a1 * a1;
  return airy(ratio * u) * airy(ratio * u) / (1 + c);
}

/// Integral of reference_intensity u du from `from` to `to` by Simpson's rule with `cells` (even) cells.
double reference_power(double from, double to, int cells, double ratio, double fa) {
  double sum = 0;
  const double step = (to - from) / cells;
  for (int i = 0; i <= cells; ++i) {
    const double u = from + i * step, weight = (i == 0 || i == cells) ? 1 : (i % 2 ? 4 : 2);
    sum += weight * u * reference_intensity(u, ratio, fa);
  }
  return sum * step / 3;
}

/// The whole integral: by brute force to x = ratio u near 300, and beyond with the mean of J1^2, 1/(pi x),
/// and S' = 1. The end is chosen where cos(2x), the swing of the power beyond x, is 0.
double reference_total(double ratio, double fa) {
  const double end = 95.25 * kPi / ratio;
  return reference_power(0, 16, 4000, ratio, fa) + reference_power(16, end, int(end) * 8 * 2, ratio, fa) +
         4 / (kPi * ratio * ratio * ratio * end);
}

TEST(ScattererLayer, IntensityByHand) {
  const double a = 5e-6, b = 4e-6, fa = 0.4, rho = fa / (kPi * a * a);
  const ScattererLayer layer(b, a, fa);
  EXPECT_NEAR(layer.shape_fraction(), rho * kPi * b * b, 1e-14);
  const double at_zero = rho * std::pow(kPi * b * b, 2);
  EXPECT_NEAR(layer.intensity(0) / at_zero, std::pow(1 - fa, 3) / (1 + fa), 1e-13);
  for (double u : {0.3, 2.7, 6.0, 30.0})
    EXPECT_NEAR(layer.intensity(u / a) / at_zero, reference_intensity(u, b / a, fa), 1e-13) << u;
}

TEST(ScattererLayer, RingsAtHalfCoverage) {
  const ScattererLayer layer(5e-6, 5e-6, 0.5);
  const auto j = [&](double u) { return layer.intensity(u / 5e-6); };
  std::vector<double> minima, maxima;
  const double step = 1e-3;
  for (double u = step; u < 6; u += step) {
    if (j(u) > j(u - step) && j(u) >= j(u + step)) maxima.push_back(u);
    if (j(u) < j(u - step) && j(u) <= j(u + step)) minima.push_back(u);
  }
  ASSERT_EQ(maxima.size(), 2u);
  ASSERT_EQ(minima.size(), 1u);  // besides the central one
  EXPECT_NEAR(maxima[0], 2.548, 1.5e-3);
  EXPECT_NEAR(minima[0], 3.832, 1.5e-3);
  EXPECT_NEAR(maxima[1], 5.392, 1.5e-3);
  EXPECT_LT(j(0), j(1));
  EXPECT_LT(j(3.8317) / j(2.548), 1e-8);
}

TEST(ScattererLayer, EnergyIdentity) {
  std::printf("(1/4 pi^2) integral of J d2q against Fr (1 - Fr):\n");
  for (double fa : {0.01, 0.1, 0.3, 0.5, 0.55, 0.6, 0.65, 0.7})
    for (double ratio : {1.0, 0.9, 0.7, 0.4}) {
      const ScattererLayer layer(ratio * 1e-5, 1e-5, fa);
      const double fr = layer.shape_fraction(), miss = layer.total() / (fr * (1 - fr)) - 1;
      std::printf("  area fraction %.2f, size ratio %.1f: %+.2f %%\n", fa, ratio, 100 * miss);
      EXPECT_NEAR(layer.normalisation() * layer.total(), fr * (1 - fr), 1e-14);
      if (fa <= 0.65) {
        EXPECT_LT(std::abs(miss), fa <= 0.6 ? 0.012 : 0.04);
      }
    }
}

TEST(ScattererLayer, TotalAgainstBruteForce) {
  double worst = 0;
  for (double fa : {0.1, 0.5, 0.7})
    for (double ratio : {1.0, 0.6, 1.0 / 16}) {
      const double miss = radial_intensity_integral(ratio, fa) / reference_total(ratio, fa) - 1;
      worst = std::max(worst, std::abs(miss));
      EXPECT_LT(std::abs(miss), 5e-6) << fa << " " << ratio;
    }
  std::printf("largest relative difference of the integral from brute force: %.1e\n", worst);
}

TEST(ScattererLayer, SparseLayersAreRandom) {
  EXPECT_NEAR(radial_intensity_integral(0.5, 0), 8, 1e-12);
  EXPECT_NEAR(ScattererLayer(1, 1, 0).normalisation(), 1, 1e-12);
  EXPECT_EQ(ScattererLayer(1, 1, 0).total(), 0);
}

TEST(ScattererLayer, Errors) {
  EXPECT_THROW(ScattererLayer(0, 1, 0.5), std::domain_error);
  EXPECT_THROW(ScattererLayer(1, -1, 0.5), std::domain_error);
  EXPECT_THROW(ScattererLayer(1.01, 1, 0.5), std::domain_error);
  EXPECT_THROW(ScattererLayer(0.01, 1, 0.5), std::domain_error);
  EXPECT_THROW(ScattererLayer(1, 1, 0.71), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
