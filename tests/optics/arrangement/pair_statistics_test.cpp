// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/pair_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

/// n points at random in a box of the given side.
HardDiscs poisson(int n, double box, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, box);
  HardDiscs d{box, box, {}, {}, std::vector<double>(n, 1.0)};
  for (int i = 0; i < n; ++i) d.x.push_back(uniform(random)), d.y.push_back(uniform(random));
  return d;
}

TEST(PairStatistics, RandomPoints) {
  std::mt19937_64 random(1);
  std::vector<double> edges;
  for (double q = 0.05; q < 5; q += 0.1) edges.push_back(q);
  DiscClasses classes(500, 0);
  std::fill(classes.begin() + 350, classes.end(), 1);
  RingStructureFactor rings(100, 100, edges, 20, classes);
  PairHistogram g(20, 40);
  for (int s = 0; s < 200; ++s) {
    const HardDiscs d = poisson(500, 100, random);
    rings.add(d), g.add(d);
  }
  double chi[4] = {0, 0, 0, 0};
  const auto z2 = [](const BlockAverage& a, double truth) {
    return (a.mean() - truth) * (a.mean() - truth) / (a.error() * a.error());
  };
  for (int r = 0; r < rings.rings(); ++r) {
    chi[0] += z2(rings.total(r), 1) / rings.rings();
    chi[1] += z2(rings.partial(r, 0, 0), 1) / rings.rings();
    chi[2] += z2(rings.partial(r, 1, 0), 0) / rings.rings();
    EXPECT_EQ(&rings.partial(r, 0, 1), &rings.partial(r, 1, 0));
    EXPECT_NEAR(rings.q(r), 0.1 * std::round(10 * rings.q(r)), 0.05);
  }
  for (int b = 0; b < g.bins(); ++b) chi[3] += z2(g.g(b), 1) / g.bins();
  for (const double c : chi) {
    EXPECT_GT(c, 0.5);
    EXPECT_LT(c, 1.8);
  }
}

TEST(PairStatistics, EqualsTheSumItAbbreviates) {
  std::mt19937_64 random(9);
  const HardDiscs d = poisson(77, 30, random);
  // A ring that holds (1, 2), (2, 1) and their mirror images alone.
  const double k = 2 * kPi / 30;
  RingStructureFactor ring(30, 30, {2.2 * k, 2.25 * k}, 100);
  ring.add(d);
  ASSERT_EQ(ring.rings(), 1);
  ASSERT_EQ(ring.vectors(0), 4);
  double mean = 0;
  for (const auto& [kx, ky] : {std::pair{1, 2}, {2, 1}, {1, -2}, {2, -1}}) {
    double re = 0, im = 0;
    for (int i = 0; i < d.size(); ++i) {
      const double phase = k * (kx * d.x[i] + ky * d.y[i]);
      re += std::cos(phase), im += std::sin(phase);
    }
    mean += (re * re + im * im) / d.size() / 4;
  }
  EXPECT_NEAR(ring.total(0).mean(), mean, 1e-5 * mean);
}

TEST(PairStatistics, SquareLattice) {
  HardDiscs d{20, 20, {}, {}, std::vector<double>(100, 1.0)};
  for (int i = 0; i < 100; ++i) d.x.push_back(2 * (i % 10) + 0.3), d.y.push_back(2 * (i / 10) + 1.1);
  std::vector<double> edges;
  for (double q = 0.2; q < 7; q += 0.1) edges.push_back(q);
  RingStructureFactor rings(20, 20, edges, 10000);
  rings.add(d);
  double total = 0;
  for (int r = 0; r < rings.rings(); ++r) {
    const double s = rings.total(r).mean() * rings.vectors(r);
    total += s;
    const bool bragg = std::abs(rings.q(r) / kPi - 1) < 0.02 || std::abs(rings.q(r) / kPi - 2) < 0.02 ||
                       std::abs(rings.q(r) / kPi - std::sqrt(2.0)) < 0.02;
    EXPECT_TRUE(bragg || s < 1e-6) << rings.q(r) << " " << s;
  }
  // N at (1,0), (0,1), (1,1), (1,-1), (2,0), (0,2) times pi.
  EXPECT_NEAR(total, 600, 1e-2);
  PairHistogram g(4.5, 50);
  g.add(d);
  EXPECT_EQ(g.g(21).mean(), 0);
  // 4 neighbours at 2, in 1.98 < r < 2.07.
  EXPECT_NEAR(g.g(22).mean() * 0.99 * 0.25 * kPi * (2.07 * 2.07 - 1.98 * 1.98), 4, 1e-9);
}

TEST(PairStatistics, Errors) {
  EXPECT_THROW(RingStructureFactor(0, 1, {1, 2}, 4), std::domain_error);
  EXPECT_THROW(RingStructureFactor(10, 10, {2, 1}, 4), std::domain_error);
  EXPECT_THROW(RingStructureFactor(10, 10, {1, 2}, 0), std::domain_error);
  EXPECT_THROW(RingStructureFactor(1e6, 1e6, {1, 20}, 4), std::domain_error);
  EXPECT_THROW(RingStructureFactor(10, 10, {1, 2}, 4, {0, -1}), std::domain_error);
  EXPECT_THROW(PairHistogram(0, 4), std::domain_error);
  EXPECT_THROW(PairHistogram(1, 0), std::domain_error);
  std::mt19937_64 random(9);
  RingStructureFactor ring(10, 10, {1, 2}, 4, {0, 1, 1});
  EXPECT_THROW(ring.add(poisson(4, 10, random)), std::domain_error);
  EXPECT_THROW(ring.add(poisson(3, 11, random)), std::domain_error);
  PairHistogram g(6, 4);
  EXPECT_THROW(g.add(poisson(3, 10, random)), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
