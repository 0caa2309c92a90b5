// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/legendre_phase.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace aureole::optics {
namespace {

TEST(LegendrePhase, TablesAndFormulasHaveTheSameMoments) {
  const auto evaluate = [](std::span<const double> mu, std::vector<std::vector<double>>& at,
                           std::vector<std::vector<double>>& mirrored) {
    for (std::size_t i = 0; i < mu.size(); ++i)
      at[0][i] = henyey_greenstein(mu[i], 0.8), mirrored[0][i] = henyey_greenstein(-mu[i], 0.8);
  };
  const PhaseTable table = tabulate_phases(evaluate, 1, 0.01, 0.1, {.relative = 1e-5}).tables[0];
  const auto of_table = LegendrePhase::table(table).moments(60),
             of_formula = LegendrePhase::henyey_greenstein(0.8).moments(60);
  for (int l = 0; l < 60; ++l) EXPECT_NEAR(of_table[l], of_formula[l], 1e-5);
  for (int l = 0; l < 4; ++l) EXPECT_NEAR(of_table[l], table.legendre(l), 1e-12);
  const LegendrePhase rayleigh = LegendrePhase::of_moments({1, 0, 0.1});
  EXPECT_NEAR(rayleigh.eval(0.5), 3 / (16 * std::numbers::pi) * 1.25, 1e-15);
}

}  // namespace
}  // namespace aureole::optics
