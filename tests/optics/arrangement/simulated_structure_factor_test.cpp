// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/simulated_structure_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "aureole/optics/arrangement/equilibrium_structure_factor.h"
#include "aureole/optics/arrangement/hard_discs.h"
#include "harness/effort.h"

namespace aureole::optics {
namespace {

HardDiscEnsemble ensemble(std::uint64_t seed, int discs, int snapshots) {
  HardDiscEnsemble e;
  e.seed = seed, e.discs = discs, e.snapshots = snapshots;
  return e;
}

struct Peak {
  double u = 0, height = 0;
};
template <class S>
Peak first_peak(const S& s) {
  Peak peak;
  for (double u = 2; u < 4; u += 0.002)
    if (s(u) > peak.height) peak = {u, s(u)};
  return peak;
}

/// S(0) = 1/(d(Fa Z)/dFa) from simulated pressures, which share nothing with the measurement of S.
double compressibility(double fa) {
  const double h = 0.02;
  double z[2];
  for (int i = 0; i < 2; ++i) {
    HardDiscSimulation simulation(1000, fa + (i ? h : -h), 77);
    simulation.advance(200);
    simulation.reset_pressure();
    simulation.advance(test::effort(900, 1800));
    z[i] = simulation.pressure() * (fa + (i ? h : -h));
  }
  return 2 * h / (z[1] - z[0]);
}

TEST(SimulatedStructureFactor, PercusYevickIsThisFarOff) {
  const struct {
    double fa, peak, difference;  // bounds for Percus-Yevick: relative height of the peak, largest |dS|
  } rows[] = {{0.1, 0.01, 0.02}, {0.2, 0.015, 0.025}, {0.3, 0.025, 0.04}, {0.4, 0.035, 0.07},
              {0.5, 0.05, 0.11}, {0.6, 0.03, 0.13},   {0.68, 0.16, 0.65}};
  std::printf(
      "        first peak of S'                          S'(0)                         largest\n"
      "  Fa    simulated           Percus-Yevick         simulated  from Z   P.-Y.     difference\n");
  for (const auto& row : rows) {
    if (!test::is_thorough() && row.fa != 0.3 && row.fa != 0.6 && row.fa != 0.68) continue;
    const SimulatedStructureFactor s(row.fa, ensemble(1, 1000, test::effort(250, 560)));
    const auto theory = [&](double u) { return hard_disc_structure_factor(u, row.fa); };
    const Peak a = first_peak([&](double u) { return s.eval(u); }), b = first_peak(theory);
    double worst = 0, worst_u = 0;
    for (double u = 0; u < 20; u += 0.01)
      if (const double d = theory(u) - s.eval(u); std::abs(d) > std::abs(worst)) worst = d, worst_u = u;
    const double zero = row.fa <= 0.6 ? compressibility(row.fa) : std::nan("");
    std::printf(
        "  %.2f  %.3f (+-%.3f) at %.2f  %.3f (%+5.1f %%) at %.2f  %.4f     %.4f   %.4f    %+.3f at %.2f\n",
        row.fa, a.height, s.error(a.u), a.u, b.height, 100 * (b.height / a.height - 1), b.u, s.eval(0), zero,
        theory(0), worst, worst_u);
    EXPECT_LT(std::abs(b.height / a.height - 1), row.peak) << row.fa;
    EXPECT_NEAR(a.u, b.u, 0.1) << row.fa;
    EXPECT_LT(std::abs(worst), row.difference) << row.fa;
    EXPECT_LT(s.error(a.u), test::effort(0.018, 0.012) * a.height) << row.fa;
    if (row.fa <= 0.6)
      EXPECT_NEAR(s.eval(0), zero, 4.5 * s.error(0) + test::effort(0.022, 0.015) * zero) << row.fa;
    else
      EXPECT_GT(s.eval(0), theory(0));  // softer on the way to freezing
    // The fit follows the data as closely as noise allows: 37 to 45 of some 200 rings are parameters.
    EXPECT_GT(s.chi_squared(), 0.5) << row.fa;
    EXPECT_LT(s.chi_squared(), 1.4) << row.fa;
  }
}

TEST(SimulatedStructureFactor, ErrorsAreHonest) {
  // Runs of different seeds differ by their stated errors.
  const double fa = 0.45;
  const int runs = 8;
  std::vector<SimulatedStructureFactor> s;
  for (int i = 0; i < runs; ++i) s.emplace_back(fa, ensemble(100 + i, 400, 160));
  double chi_squared = 0;
  int n = 0;
  for (double u = 0.25; u < 14; u += 0.25) {
    double mean = 0, squares = 0, variance = 0;
    for (const auto& run : s) mean += run.eval(u) / runs;
    for (const auto& run : s) {
      squares += (run.eval(u) - mean) * (run.eval(u) - mean) / (runs - 1);
      variance += run.error(u) * run.error(u) / runs;
    }
    chi_squared += squares / variance, ++n;
  }
  std::printf("spread of runs over stated error: chi2 %.2f\n", chi_squared / n);
  EXPECT_GT(chi_squared / n, 0.5);
  EXPECT_LT(chi_squared / n, 2);
}

TEST(SimulatedStructureFactor, ThreadsDoNotMatter) {
  std::vector<double> first;
  for (const int threads : {0, 1, 2, 5, 20}) {
    const SimulatedStructureFactor s(0.5, ensemble(4, 150, 64),
                                     threads ? std_thread_for(threads) : ParallelFor(serial_for));
    std::vector<double> values;
    for (double u = 0; u < 50; u += 0.1) values.push_back(s.eval(u)), values.push_back(s.error(u));
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << threads;
  }
  EXPECT_NE(SimulatedStructureFactor(0.5, ensemble(5, 150, 64)).eval(3), first[60]);
}

TEST(SimulatedStructureFactor, LimitsAndSmoothness) {
  EXPECT_EQ(SimulatedStructureFactor(0).eval(1.3), 1);
  const SimulatedStructureFactor thin(0.02);
  for (double u = 0; u < 50; u += 0.37) {
    EXPECT_NEAR(thin.eval(u), hard_disc_structure_factor(u, 0.02), 2e-5) << u;
    EXPECT_NEAR(thin.eval(u), 1, 0.08);
  }
  for (const double fa : {0.04, 0.35, 0.68}) {
    const SimulatedStructureFactor s(fa, ensemble(6, 300, 160));
    double before = s.eval(0);
    for (double u = 0; u < 45; u += 0.005) {
      const double value = s.eval(u);
      EXPECT_GT(value, 0) << u;
      EXPECT_LT(std::abs(value - before), fa < 0.5 ? 0.01 : 0.25) << u;
      EXPECT_EQ(value, s.eval(-u));
      before = value;
    }
    EXPECT_NEAR(s.eval(40 - 1e-9), s.eval(40 + 1e-9), 1e-5);
    EXPECT_NEAR(s.eval(100), hard_disc_structure_factor(100, fa), 1e-4);
    EXPECT_NEAR(s.eval(1e4), 1, 1e-4);
    EXPECT_EQ(s.eval(3, 4), s.eval(5));
  }
}

TEST(EquilibriumStructureFactor, IsThatOfSimulations) {
  // The table at area fractions between its rows, and simulations with other random numbers.
  for (const double fa : {0.15, 0.47, 0.65}) {
    const SimulatedStructureFactor s(fa, ensemble(31, 1000, test::effort(400, 2400)));
    double chi_squared = 0, theory = 0;
    int n = 0;
    for (double u = 0.25; u < 14; u += 0.25, ++n) {
      const double value = equilibrium_structure_factor(HardDiscWave(u), u, fa);
      chi_squared += std::pow((value - s.eval(u)) / s.error(u), 2);
      theory += std::pow((hard_disc_structure_factor(u, fa) - s.eval(u)) / s.error(u), 2);
    }
    std::printf("Fa %.2f: chi2 of the table %.2f, of Percus-Yevick %.1f\n", fa, chi_squared / n, theory / n);
    EXPECT_LT(chi_squared / n, 2.5) << fa;
    if (fa > 0.2) EXPECT_GT(theory, 4 * chi_squared) << fa;
  }
}

TEST(EquilibriumStructureFactor, Limits) {
  const auto s = [](double u, double fa) { return equilibrium_structure_factor(HardDiscWave(u), u, fa); };
  for (double u = 0; u < 50; u += 0.37) {
    EXPECT_EQ(s(u, 0), 1) << u;
    EXPECT_NEAR(s(u, 1e-4), hard_disc_structure_factor(u, 1e-4), 1e-5) << u;
    for (const double fa : {0.05, 0.3, 0.5, 0.68}) {
      EXPECT_GT(s(u, fa), 0) << u << " " << fa;
      EXPECT_NEAR(s(u, fa), s(u, fa - 1e-6), 1e-3) << u << " " << fa;
    }
  }
  EXPECT_EQ(s(40, 0.5), hard_disc_structure_factor(40, 0.5));
  for (const double fa : {-0.01, 0.69, double(NAN)})
    EXPECT_THROW(equilibrium_correction(1, fa), std::domain_error);
}

TEST(SimulatedStructureFactor, Errors) {
  for (const double fa : {-0.1, 0.681, std::nan("")})
    EXPECT_THROW(SimulatedStructureFactor{fa}, std::domain_error) << fa;
  EXPECT_THROW(SimulatedStructureFactor(0.5, ensemble(1, 3, 100)), std::domain_error);
  EXPECT_THROW(SimulatedStructureFactor(0.5, ensemble(1, 100, 3)), std::domain_error);
  EXPECT_THROW(HardDiscMixture({1, 2}, {1}, 0.5), std::domain_error);
  EXPECT_THROW(HardDiscMixture({1, -2}, {1, 1}, 0.5), std::domain_error);
  EXPECT_THROW(HardDiscMixture({1, 2}, {1, 0}, 0.5), std::domain_error);
  EXPECT_THROW(HardDiscMixture({1, 2}, {1, 1}, 0.8), std::domain_error);
  EXPECT_THROW(PartialStructureFactors(HardDiscMixture({1}, {1}, 0.5), 0), std::domain_error);
  EXPECT_THROW(simulate_partial_structure_factors(HardDiscMixture({1, 2}, {1, 1}, 0.69)), std::domain_error);
  // A disc as large as the box.
  EXPECT_THROW(
      simulate_partial_structure_factors(HardDiscMixture({1, 50}, {0.99, 0.01}, 0.5), ensemble(1, 100, 64)),
      std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
