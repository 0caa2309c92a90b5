// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/phase_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

PhaseEvaluator evaluator(std::vector<std::function<double(double)>> functions) {
  return [=](std::span<const double> mu, std::vector<std::vector<double>>& at,
             std::vector<std::vector<double>>& mirrored) {
    for (std::size_t f = 0; f < functions.size(); ++f)
      for (std::size_t i = 0; i < mu.size(); ++i)
        at[f][i] = functions[f](mu[i]), mirrored[f][i] = functions[f](-mu[i]);
  };
}
double henyey_greenstein(double mu, double g) {
  return (1 - g * g) / (4 * kPi) / std::pow(1 + g * g - 2 * g * mu, 1.5);
}

TEST(PhaseTable, InterpolationKeepsItsBound) {
  // A forward peak 1e-3 wide, and a bow that is narrower than the first steps.
  const auto peaked = [](double mu) { return henyey_greenstein(mu, 0.999) + 0.02; };
  const auto bow = [](double mu) {
    const double degrees = std::acos(mu) * 180 / kPi;
    return 0.1 + 0.5 * std::exp(-0.5 * std::pow((degrees - 138) / 0.4, 2));
  };
  const PhaseTables t = tabulate_phases(evaluator({peaked, bow}), 2, 1e-4, 0.01);
  EXPECT_LE(t.error, 2e-3);
  EXPECT_EQ(t.tables[0].mu, t.tables[1].mu);
  double worst = 0;
  for (int i = 0; i <= 20000; ++i) {
    // Angles crowd towards 0.
    const double mu = std::cos(kPi * std::pow(i / 20000.0, 3));
    worst = std::max(worst, std::abs(t.tables[0].eval(mu) * t.integrals[0] / peaked(mu) - 1));
    worst = std::max(worst, std::abs(t.tables[1].eval(mu) * t.integrals[1] / bow(mu) - 1));
  }
  EXPECT_LT(worst, 2.2e-3);
  std::printf("%zu nodes, error %.2g\n", t.tables[0].mu.size(), worst);
  EXPECT_LT(t.tables[0].mu.size(), 1500u);
  EXPECT_NEAR(t.integrals[0], 1 + 0.02 * 4 * kPi, 2e-3);
}

TEST(PhaseTable, Moments) {
  PhaseAccuracy fine;
  fine.relative = 1e-5;
  const PhaseTable t =
      tabulate_phases(evaluator({[](double mu) { return henyey_greenstein(mu, 0.7); }}), 1, 0.01, 0.05, fine)
          .tables[0];
  for (int l = 0; l <= 3; ++l) EXPECT_NEAR(t.legendre(l), std::pow(0.7, l), 1e-5) << l;
  // Exact of the table: two triangles.
  const PhaseTable triangles{{-1, 0, 1}, {0, 3 / (4 * kPi), 1 / (4 * kPi)}};
  EXPECT_NEAR(triangles.integral(), 2 * kPi * (1.5 + 2) / (4 * kPi), 1e-15);
  EXPECT_NEAR(triangles.asymmetry(), (-0.5 + 5.0 / 6) / 3.5, 1e-15);
}

TEST(PhaseTable, SamplesFollowTheTable) {
  const PhaseTable t{{-1, -0.2, 0.3, 1}, {0.1, 0, 0.5, 0.02}};
  const auto cdf = t.cdf();
  EXPECT_EQ(cdf.front(), 0);
  EXPECT_EQ(cdf.back(), 1);
  EXPECT_EQ(t.sample(cdf, 0), -1);
  EXPECT_DOUBLE_EQ(t.sample(cdf, 1), 1);
  // The cumulative density at each sample, by many trapezoids, is the random number.
  const double total = t.integral();
  for (double u = 0.005; u < 1; u += 0.01) {
    const double mu = t.sample(cdf, u);
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) sum += t.eval(-1 + (mu + 1) * (i + 0.5) / kSteps);
    EXPECT_NEAR(2 * kPi * sum * (mu + 1) / kSteps / total, u, 1e-6);
  }
}

TEST(PhaseTable, NodesRunOutOpenly) {
  PhaseAccuracy few;
  few.most_nodes = 50;
  const auto t =
      tabulate_phases(evaluator({[](double mu) { return 1 + std::sin(300 * mu); }}), 1, 0.1, 0.1, few);
  EXPECT_GT(t.error, few.relative);
  EXPECT_NEAR(t.tables[0].integral(), 1, 1e-12);
  EXPECT_THROW(tabulate_phases(evaluator({[](double) { return 0.0; }}), 1, 0.1, 0.1), std::domain_error);
  EXPECT_THROW(tabulate_phases(evaluator({[](double mu) { return mu; }}), 1, 0.1, 0.1), std::domain_error);
  EXPECT_THROW(tabulate_phases(evaluator({[](double) { return std::nan(""); }}), 1, 0.1, 0.1),
               std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
