// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/hard_disc_pair_correlation.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {
namespace {

TEST(HardDiscPairCorrelation, IsTheTransformOfTheStructureFactor) {
  // S = 1 + 2 Fa integral of (g - 1) J0(u r) r dr.
  using Rule = boost::math::quadrature::gauss<double, 7>;
  for (const double fa : {0.02, 0.5}) {
    std::vector<std::pair<double, double>> nodes;  // r, and (g - 1) r dr
    const auto panel = [&](double from, double to, const auto& place, const auto& slope) {
      for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
        for (int side = Rule::abscissa()[k] > 0 ? -1 : 1; side <= 1; side += 2) {
          const double t = 0.5 * (from + to + side * (to - from) * Rule::abscissa()[k]), r = place(t);
          const double width = 0.5 * (to - from) * Rule::weights()[k] * slope(t);
          nodes.emplace_back(r, (hard_disc_pair_correlation(r, fa) - 1) * r * width);
        }
    };
    // Inside of contact g changes as a root of 2 - r.
    for (int i = 0; i < 4; ++i)
      panel(
          0.25 * i, 0.25 * (i + 1), [](double t) { return 2 - 2 * t * t; }, [](double t) { return 4 * t; });
    for (double r = 2; r < 20; r += 0.5)
      panel(
          r, r + 0.5, [](double t) { return t; }, [](double) { return 1.0; });
    for (const double u : {0.0, 1.0, 3.2, 6.5}) {
      double sum = 1;
      for (const auto& [r, weight] : nodes) sum += 2 * fa * weight * boost::math::cyl_bessel_j(0, u * r);
      EXPECT_NEAR(sum, hard_disc_structure_factor(u, fa), 2e-4) << fa << " " << u;
    }
  }
}

TEST(HardDiscPairCorrelation, HasTheOverlapOfExclusionsAtLowDensity) {
  constexpr double kFraction = 1e-4;
  for (const double r : {2.0, 2.7, 3.9, 4.0, 6.0}) {
    const double overlap = r < 4 ? 8 * std::acos(r / 4) - r / 2 * std::sqrt(16 - r * r) : 0;
    EXPECT_NEAR(hard_disc_pair_correlation(r, kFraction), 1 + kFraction * overlap / std::numbers::pi, 1e-7);
  }
  EXPECT_NEAR(hard_disc_pair_correlation(1, kFraction), 0, 1e-3);
  EXPECT_EQ(hard_disc_pair_correlation(1.9, 0), 0);
  EXPECT_EQ(hard_disc_pair_correlation(2, 0), 1);
}

TEST(HardDiscPairCorrelation, RefusesWhatTheModelDoesNotHave) {
  EXPECT_THROW(hard_disc_pair_correlation(3, 0.8), std::domain_error);
  EXPECT_THROW(hard_disc_pair_correlation(3, -0.1), std::domain_error);
  EXPECT_THROW(hard_disc_pair_correlation(-1, 0.5), std::domain_error);
  EXPECT_THROW(hard_disc_pair_correlation(std::nan(""), 0.5), std::domain_error);
  EXPECT_THROW(hard_disc_pair_correlation(201, 0.5), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
