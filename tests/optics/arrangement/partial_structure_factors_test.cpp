// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/partial_structure_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "aureole/optics/arrangement/simulated_structure_factor.h"

namespace aureole::optics {
namespace {

HardDiscEnsemble ensemble(std::uint64_t seed, int discs, int snapshots) {
  HardDiscEnsemble e;
  e.seed = seed, e.discs = discs, e.snapshots = snapshots;
  return e;
}

TEST(PartialStructureFactors, OneSizeIsPercusYevick) {
  for (const double fa : {0.1, 0.5, 0.7}) {
    const PartialStructureFactors one(HardDiscMixture({2}, {5}, fa), 20);
    // Labels on equal discs: S_ml = delta_ml + sqrt(x_m x_l) (S - 1).
    const PartialStructureFactors two(HardDiscMixture({1, 1}, {0.3, 0.7}, fa), 40);
    for (double u = 0; u < 28; u += 0.31) {
      const double s = hard_disc_structure_factor(u, fa);
      EXPECT_NEAR(one.eval(0, 0, u / 2), s, 3e-4 * s) << u;
      EXPECT_NEAR(two.eval(0, 0, u), 1 + 0.3 * (s - 1), 3e-4 * s) << u;
      EXPECT_NEAR(two.eval(0, 1, u), std::sqrt(0.21) * (s - 1), 3e-4 * s) << u;
      EXPECT_EQ(two.eval(0, 1, u), two.eval(1, 0, u));
    }
  }
}

TEST(PartialStructureFactors, SimulatedMixture) {
  const HardDiscMixture mixture({0.7, 1.3}, {0.6, 0.4}, 0.45);
  const PartialStructureFactors theory(mixture, 40);
  const PartialStructureFactors simulated =
      simulate_partial_structure_factors(mixture, ensemble(3, 800, 480));
  EXPECT_EQ(simulated.classes(), 2);
  EXPECT_NEAR(simulated.fraction(0), 0.6, 1e-3);
  EXPECT_GT(simulated.chi_squared(), 0.5);
  EXPECT_LT(simulated.chi_squared(), 1.4);
  double worst = 0;
  for (double q = 0; q < 60; q += 0.05) {
    for (int m = 0; m < 2; ++m)
      for (int l = 0; l < 2; ++l)
        worst = std::max(worst, std::abs(simulated.eval(m, l, q) - theory.eval(m, l, q)));
    // No amplitudes give a negative intensity.
    EXPECT_GE(simulated.eval(0, 0, q) * simulated.eval(1, 1, q),
              simulated.eval(0, 1, q) * simulated.eval(0, 1, q));
  }
  std::printf("mixture: theory is %.3f from the simulation at most, noise %.3f at its peak\n", worst,
              simulated.error(0, 0, 3));
  EXPECT_LT(worst, 0.12);
  EXPECT_LT(simulated.error(0, 0, 3), 0.02);
  EXPECT_GT(simulated.error(0, 0, 3), 0.0005);
}

TEST(PartialStructureFactors, ManyClasses) {
  std::vector<double> radii, fractions;
  for (int m = 0; m < 7; ++m) radii.push_back(std::exp(0.12 * (m - 3))), fractions.push_back(1 + m % 3);
  const PartialStructureFactors s =
      simulate_partial_structure_factors(HardDiscMixture(radii, fractions, 0.55), ensemble(3, 700, 160));
  for (double q = 0; q < 45; q += 0.1) {
    double intensity = 0;
    for (int m = 0; m < 7; ++m)
      for (int l = 0; l < 7; ++l)
        intensity += std::sqrt(s.fraction(m) * s.fraction(l)) * ((m + l) % 2 ? -1 : 1) * s.eval(m, l, q);
    EXPECT_GT(intensity, 0) << q;
  }
  EXPECT_LT(s.chi_squared(), 1.4);
}

}  // namespace
}  // namespace aureole::optics
