// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aureole::optics {
namespace {

// Rosenbrock's valley, whose minimum is at (1, 1).
TEST(LeastSquares, FindsTheEndOfACurvedValley) {
  const auto r =
      least_squares([](const std::vector<double>& x,
                       std::vector<double>& r) { r[0] = 10 * (x[1] - x[0] * x[0]), r[1] = 1 - x[0]; },
                    2, {{-1.2, -5, 5}, {1, -5, 5}}, 200);
  EXPECT_NEAR(r.values[0], 1, 1e-5);
  EXPECT_NEAR(r.values[1], 1, 1e-5);
  EXPECT_LT(r.sum_of_squares, 1e-9);
}

// A straight line: values and covariance are those of linear regression.
TEST(LeastSquares, CovarianceOfALineIsThatOfRegression) {
  const double x[5] = {0, 1, 2, 3, 4}, y[5] = {1.1, 2.9, 5.2, 6.8, 9.1};
  const auto r = least_squares(
      [&](const std::vector<double>& p, std::vector<double>& r) {
        for (std::size_t i = 0; i < 5; ++i) r[i] = p[0] + p[1] * x[i] - y[i];
      },
      5, {{0, -100, 100}, {0, -100, 100}});
  EXPECT_NEAR(r.values[1], 1.99, 1e-6);
  EXPECT_NEAR(r.values[0], 1.04, 1e-6);
  // n = 5, sum x = 10, sum x^2 = 30: the inverse of [[5, 10], [10, 30]] is [[30, -10], [-10, 5]]/50.
  EXPECT_NEAR(r.covariance[0], 0.6, 1e-6);
  EXPECT_NEAR(r.covariance[1], -0.2, 1e-6);
  EXPECT_NEAR(r.covariance[3], 0.1, 1e-6);
}

TEST(LeastSquares, BoundsHold) {
  const auto r = least_squares(
      [](const std::vector<double>& x, std::vector<double>& r) { r[0] = x[0] + 3, r[1] = x[1] - 0.5; }, 2,
      {{1, 0, 2}, {0, -1, 1}});
  EXPECT_EQ(r.values[0], 0);
  EXPECT_NEAR(r.values[1], 0.5, 1e-6);
  EXPECT_EQ(r.covariance[0], 0) << "a parameter at its bound has no interval";
}

}  // namespace
}  // namespace aureole::optics
