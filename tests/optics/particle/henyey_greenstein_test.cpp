// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/henyey_greenstein.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

PhaseTable table_of(const std::function<double(double)>& p) {
  PhaseAccuracy fine;
  fine.relative = 1e-5;
  const auto both = [&](std::span<const double> mu, std::vector<std::vector<double>>& at,
                        std::vector<std::vector<double>>& mirrored) {
    for (std::size_t i = 0; i < mu.size(); ++i) at[0][i] = p(mu[i]), mirrored[0][i] = p(-mu[i]);
  };
  return tabulate_phases(both, 1, 0.01, 0.05, fine).tables[0];
}

TEST(HenyeyGreenstein, IsNormalisedWithMeanCosineG) {
  for (const double g : {-0.6, 0.0, 0.3, 0.9}) {
    double sum = 0, cosine = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = -1 + (i + 0.5) * 2 / kSteps,
                   mass = 2 * std::numbers::pi * henyey_greenstein(mu, g) * 2 / kSteps;
      sum += mass, cosine += mass * mu;
    }
    EXPECT_NEAR(sum, 1, 2e-5) << g;
    EXPECT_NEAR(cosine, g, 2e-5) << g;
  }
  EXPECT_THROW(henyey_greenstein(0, 1), std::domain_error);
}

TEST(HenyeyGreenstein, FitsFindWhatMadeTheTable) {
  EXPECT_NEAR(fit_henyey_greenstein(table_of([](double mu) { return henyey_greenstein(mu, 0.65); })), 0.65,
              1e-4);
  const DoubleHenyeyGreenstein made{0.85, 0.9, -0.4};
  const auto fit = fit_double_henyey_greenstein(table_of([&](double mu) { return made.eval(mu); }));
  EXPECT_NEAR(fit.share, made.share, 1e-3);
  EXPECT_NEAR(fit.g1, made.g1, 1e-3);
  EXPECT_NEAR(fit.g2, made.g2, 1e-3);
  // Rayleigh: moments 0, 1/10, 0.
  const auto rayleigh = fit_double_henyey_greenstein(table_of([](double mu) { return 1 + mu * mu; }));
  EXPECT_NEAR(rayleigh.g1, std::sqrt(0.1), 1e-4);
  EXPECT_NEAR(rayleigh.g2, -std::sqrt(0.1), 1e-4);
  EXPECT_NEAR(rayleigh.share, 0.5, 1e-4);
}

TEST(HenyeyGreenstein, WhereMomentsHaveNoMixture) {
  // 1 + mu: moments 1/3, 0, 0; the second is below the square of the first, which no mixture has. One of them
  // alone is as near as a mixture comes.
  const auto fit = fit_double_henyey_greenstein(table_of([](double mu) { return 1 + mu; }));
  EXPECT_NEAR(fit.asymmetry(), 1.0 / 3, 1e-6);
  EXPECT_GE(fit.share, 0);
  EXPECT_LE(fit.share, 1);
  const double second = fit.share * fit.g1 * fit.g1 + (1 - fit.share) * fit.g2 * fit.g2;
  EXPECT_NEAR(second, 1.0 / 9, 2e-2);
}

}  // namespace
}  // namespace aureole::optics
