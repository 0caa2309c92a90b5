// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace aureole::optics {

LeastSquaresResult least_squares(
    const std::function<void(const std::vector<double>&, std::vector<double>&)>& residuals, std::size_t count,
    const std::vector<LeastSquaresParameter>& parameters, int most_iterations) {
  const Eigen::Index n = Eigen::Index(parameters.size()), m = Eigen::Index(count);
  const auto index = [](Eigen::Index i) { return std::size_t(i); };
  std::vector<double> buffer;
  const auto evaluate = [&](const Eigen::VectorXd& x) {
    buffer.assign(count, 0);
    residuals({x.data(), x.data() + n}, buffer);
    Eigen::VectorXd r(m);
    for (Eigen::Index i = 0; i < m; ++i) r[i] = std::isfinite(buffer[index(i)]) ? buffer[index(i)] : 1e150;
    return r;
  };
  const auto within = [&](Eigen::VectorXd x) {
    for (Eigen::Index i = 0; i < n; ++i)
      x[i] = std::clamp(x[i], parameters[index(i)].low, parameters[index(i)].high);
    return x;
  };
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = parameters[index(i)].start;
  x = within(x);
  Eigen::VectorXd r = evaluate(x);
  double sum = r.squaredNorm(), damping = 1e-3;
  Eigen::MatrixXd jacobian(m, n);
  const auto differentiate = [&] {
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& p = parameters[index(i)];
      double step = 1e-4 * std::max(std::abs(x[i]), 1e-3 * (p.high - p.low));
      if (x[i] + step > p.high) step = -step;
      Eigen::VectorXd moved = x;
      moved[i] += step;
      jacobian.col(i) = (evaluate(moved) - r) / step;
    }
  };
  LeastSquaresResult result;
  bool is_done = false;
  for (; result.iterations < most_iterations && !is_done; ++result.iterations) {
    differentiate();
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    for (;;) {
      Eigen::MatrixXd damped = normal;
      // Parameters at a bound that would leave it are held.
      Eigen::VectorXd right = -gradient;
      for (Eigen::Index i = 0; i < n; ++i) {
        damped(i, i) += damping * std::max(normal(i, i), 1e-300);
        const auto& p = parameters[index(i)];
        const bool is_held = (x[i] <= p.low && gradient[i] > 0) || (x[i] >= p.high && gradient[i] < 0);
        if (!is_held) continue;
        damped.row(i).setZero(), damped.col(i).setZero();
        damped(i, i) = 1, right[i] = 0;
      }
      const Eigen::VectorXd next = within(x + damped.ldlt().solve(right));
      const Eigen::VectorXd at = evaluate(next);
      if (const double s = at.squaredNorm(); s < sum) {
        is_done = sum - s < 1e-10 * sum;
        x = next, r = at, sum = s, damping = std::max(0.2 * damping, 1e-12);
        break;
      }
      damping *= 5;
      if (damping > 1e12) {
        is_done = true;
        break;
      }
    }
  }
  differentiate();
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  std::vector<bool> is_free(std::size_t(n), true);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& p = parameters[index(i)];
    const double margin = 1e-9 * (p.high - p.low);
    is_free[index(i)] = x[i] > p.low + margin && x[i] < p.high - margin && normal(i, i) > 0;
    if (is_free[index(i)]) continue;
    normal.row(i).setZero(), normal.col(i).setZero();
    normal(i, i) = 1;
  }
  // Scaled by the diagonal, so that parameters of different sizes are told apart.
  Eigen::VectorXd scale = normal.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = scale.cwiseInverse().asDiagonal() *
                                  scaled.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) *
                                  scale.cwiseInverse().asDiagonal();
  result.values.assign(x.data(), x.data() + n);
  result.covariance.resize(std::size_t(n * n));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      result.covariance[index(i * n + k)] = is_free[index(i)] && is_free[index(k)] ? inverse(i, k) : 0;
  result.sum_of_squares = sum;
  return result;
}

}  // namespace aureole::optics
