// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/scatterer_layer.h"

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
  EXPECT_THROW(RadialTable(1.5, 0.5), std::domain_error);
  EXPECT_THROW(RadialTable(1, std::nan("")), std::domain_error);
}

class RadialTableTest : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(RadialTableTest, MatchesQuadrature) {
  const auto [ratio, fa] = GetParam();
  const RadialTable table(ratio, fa);
  const double total = reference_total(ratio, fa);

  double peak = 0, worst = 0;
  for (double u = 0; u < 10 / ratio; u += 0.01) peak = std::max(peak, reference_intensity(u, ratio, fa));
  double worst_ring = 0;  // relative to the envelope of the rings, where the table is coarse
  for (double u = 0; u < 4096; u += u < 40 ? 0.00173 : 0.1571) {
    const double miss = std::abs(total * table.eval(float(u)) - reference_intensity(float(u), ratio, fa));
    worst = std::max(worst, miss);
    if (u > 40) worst_ring = std::max(worst_ring, miss * kPi * std::pow(ratio * u, 3) / 8);
  }
  EXPECT_LT(worst / peak, 1e-4);
  EXPECT_LT(worst_ring, 0.015);

  double power = 0, from = 0, worst_power = 0;
  for (double to : {0.1, 1.0, 2.548, 3.832, 8.0, 33.3, 157.0, 500.0, 3000.0}) {
    power += reference_power(from, to, std::max(800, int(8 * (to - from)) * 2), ratio, fa) / total;
    worst_power = std::max(worst_power, std::abs(table.cdf(to) / power - 1));
    EXPECT_NEAR(table.cdf(to) / power, 1, 1e-3) << to;
    from = to;
  }
  // Beyond the table only its end is checked, where the tail holds this much.
  const double beyond = 4 / (kPi * std::pow(ratio, 3) * 8192 * total);
  EXPECT_NEAR((1 - table.cdf(8192)) / beyond, 1, 0.05);
  std::printf(
      "size ratio %.3f, area fraction %.2f: |table - J|/peak %.1e, rings beyond u = 40 %.1e, power %.1e\n",
      ratio, fa, worst / peak, worst_ring, worst_power);
}

TEST_P(RadialTableTest, SamplesItsOwnDensityExactly) {
  const auto [ratio, fa] = GetParam();
  const RadialTable table(ratio, fa);
  for (double u_max : {1e-5, 0.002, 0.5, 2.9, 31.999, 32.001, 157.0, 4095.99, 4097.0, 1e6}) {
    double previous = 0;
    for (int i = 0; i < 2000; ++i) {
      const double xi = (i + 0.37) / 2000, u = table.sample(xi, u_max);
      ASSERT_GE(u, previous);
      ASSERT_LE(u, u_max);
      ASSERT_NEAR(table.cdf(u) / table.cdf(u_max), xi, 1e-10) << u_max;
      previous = u;
    }
    EXPECT_EQ(table.sample(0, u_max), 0);
    EXPECT_LE(table.sample(1 - 1e-16, u_max), u_max);
  }
  // The density is the slope of the distribution and u times what `eval` returns.
  for (double u : {1e-4, 0.0119, 1.2345, 5.0003, 31.9983, 32.01, 100.123, 4000.01, 6000.0}) {
    const double d = 1e-6 * std::max(1.0, u);
    EXPECT_NEAR((table.cdf(u + d) - table.cdf(u - d)) / (2 * d) / table.pdf(u), 1, 1e-4) << u;
    // A float tells the phase of a far ring only so well: the difference counts against the ring's height.
    const double height = u < 5 ? table.pdf(u) : std::max({table.pdf(u - 1), table.pdf(u), table.pdf(u + 1)});
    EXPECT_NEAR(u * table.eval(float(u)) / height, table.pdf(u) / height, u < 100 ? 1e-5 : 1e-3) << u;
  }
  EXPECT_EQ(table.pdf(0), 0);
  EXPECT_EQ(table.cdf(0), 0);
  EXPECT_GT(table.eval(0), 0);
  EXPECT_TRUE(std::isfinite(table.eval(0)));
  EXPECT_EQ(table.eval(1e30f), 0);
}

TEST_P(RadialTableTest, SamplesFollowTheReference) {
  const auto [ratio, fa] = GetParam();
  const RadialTable table(ratio, fa);
  const double u_max = 60;  // counts of an even sequence in rings against the power in them by quadrature
  const int samples = 400000, rings = 40;
  std::vector<int> count(rings);
  for (int i = 0; i < samples; ++i)
    ++count[std::min(rings - 1, int(table.sample((i + 0.5) / samples, u_max) / 1.5))];
  const double total = reference_power(0, u_max, 20000, ratio, fa);
  for (int ring = 0; ring < rings; ++ring) {
    const double expected = reference_power(1.5 * ring, 1.5 * (ring + 1), 600, ratio, fa) / total * samples;
    EXPECT_NEAR(count[ring], expected, 2 + (ring < 21 ? 1e-3 : 1e-2) * expected) << ring;
  }
}

INSTANTIATE_TEST_SUITE_P(Layers, RadialTableTest,
                         testing::Values(std::pair{1.0, 0.1}, std::pair{1.0, 0.5}, std::pair{1.0, 0.7},
                                         std::pair{0.6, 0.65}, std::pair{0.125, 0.5}));

}  // namespace
}  // namespace aureole::optics
