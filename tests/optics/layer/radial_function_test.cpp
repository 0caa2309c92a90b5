// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/radial_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

double airy2(double x) {
  const double a = x < 1e-6 ? 1 : 2 * std::cyl_bessel_j(1.0, x) / x;
  return a * a;
}

TEST(RadialFunction, FollowsAiry) {
  const RadialFunction f(airy2, 1024, true);
  double worst = 0, worst_ring = 0;
  for (double u = 0; u < 1000; u += u < 40 ? 0.00173 : 0.1571) {
    const double miss = std::abs(double(f.eval(float(u))) - airy2(double(float(u))));
    worst = std::max(worst, miss);
    if (u > 40) worst_ring = std::max(worst_ring, miss * kPi * std::pow(u, 3) / 8);
  }
  EXPECT_LT(worst, 3e-7);
  EXPECT_LT(worst_ring, 2e-3);  // of the rings' height
  // Beyond the end the mean of the rings, 4/(pi u^3).
  EXPECT_NEAR(f.eval(2000) * std::pow(2000.0, 3) * kPi / 4, 1, 0.02);
  EXPECT_EQ(f.eval(0), 1);
  EXPECT_EQ(RadialFunction(airy2, 64, false).eval(64), 0);
  std::printf("2 J1(u)/u squared: error %.1e of the peak, %.1e of the rings beyond u = 40\n", worst,
              worst_ring);
}

TEST(RadialFunction, FollowsTheHighestFrequency) {
  const RadialFunction f([](double u) { return std::sin(2 * u); }, 256, false);
  double fine = 0, coarse = 0;
  for (float u = 0; u < 255; u += 0.00317f) {
    double& worst = u < 64 ? fine : coarse;
    worst = std::max(worst, std::abs(double(f.eval(u)) - std::sin(2 * double(u))));
  }
  EXPECT_LT(fine, 2.5e-7);
  EXPECT_LT(coarse, 6e-5);
  std::printf("sin(2 u): error %.1e up to u = 64, %.1e beyond\n", fine, coarse);
}

TEST(RadialDistribution, SamplesItsOwnDensityExactly) {
  const auto density = [](double u) { return u * airy2(u) * (1.2 + std::sin(u)); };
  const RadialDistribution d(density, 512, 4 * 1.2 / kPi);
  for (double u_max : {1e-5, 0.002, 0.5, 2.9, 63.999, 64.001, 157.0, 511.99, 513.0, 1e6}) {
    double previous = 0;
    for (int i = 0; i < 2000; ++i) {
      const double xi = (i + 0.37) / 2000, u = d.sample(xi, u_max);
      ASSERT_GE(u, previous);
      ASSERT_LE(u, u_max);
      ASSERT_NEAR(d.cdf(u) / d.cdf(u_max), xi, 1e-10) << u_max;
      previous = u;
    }
    EXPECT_EQ(d.sample(0, u_max), 0);
    EXPECT_LE(d.sample(1 - 1e-16, u_max), u_max);
  }
  // The density is the slope of the distribution.
  for (double u : {0.0119, 1.2345, 5.0003, 31.9983, 64.01, 100.123, 500.01, 6000.0}) {
    const double h = 1e-6 * std::max(1.0, u), slope = (d.cdf(u + h) - d.cdf(u - h)) / (2 * h);
    // Single precision limits the phase of a far ring: the difference is relative to the ring's height.
    const double height = std::max(slope, 1e-2 * u * 8 / (kPi * u * u * u));
    EXPECT_NEAR(u * double(d.eval(float(u))) / height, slope / height, u < 100 ? 1e-4 : 2e-3) << u;
  }
  EXPECT_EQ(d.cdf(0), 0);
  EXPECT_TRUE(std::isfinite(d.eval(0)));
  EXPECT_EQ(d.eval(1e30f), 0);
  EXPECT_NEAR(d.cdf(1e12), 1, 1e-9);
}

TEST(RadialDistribution, EmptyStretches) {
  const RadialDistribution d([](double u) { return u > 3 && u < 5 ? 1.0 : 0.0; }, 64, 0);
  for (int i = 0; i < 1000; ++i) {
    const double u = d.sample((i + 0.5) / 1000, 100);
    EXPECT_GT(u, 2.95);
    EXPECT_LT(u, 5.05);
    EXPECT_GT(d.eval(float(u)), 0);
  }
}

}  // namespace
}  // namespace aureole::optics
