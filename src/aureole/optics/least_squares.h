// SPDX-License-Identifier: Apache-2.0
// Nonlinear least squares of few parameters within bounds, with their covariance.
#pragma once

#include <functional>
#include <vector>

namespace aureole::optics {

struct LeastSquaresParameter {
  double start, low, high;
};

struct LeastSquaresResult {
  std::vector<double> values;
  /// Covariance of the values, row by row, for residuals of unit variance; of a parameter at a bound 0.
  std::vector<double> covariance;
  double sum_of_squares = 0;
  int iterations = 0;
};

/// Minimises the sum of squares of the residuals, of which there are `count`, by the method of Levenberg and Marquardt (D. W.
/// Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", J. SIAM 11(2), 1963). Derivatives are differences.
/// Residuals that are not finite count as very large.
LeastSquaresResult least_squares(
    const std::function<void(const std::vector<double>&, std::vector<double>&)>& residuals, std::size_t count,
    const std::vector<LeastSquaresParameter>& parameters, int most_iterations = 60);

}  // namespace aureole::optics
