// SPDX-License-Identifier: Apache-2.0
// Cholesky factorisation of small, dense, symmetric positive definite matrices.
#pragma once

#include <cmath>
#include <vector>

namespace aureole::optics {

/// The factorisation A = L L^T of an n x n matrix in row-major order, of which only the lower triangle is
/// read. If `is_definite()` is false there is no factor, and `solve` and `inverse` must not be called.
class Cholesky {
public:
  Cholesky(std::vector<double> a, int n) : n_(n), l_(std::move(a)) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) {
        double sum = at(i, j);
        for (int k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
        if (i == j && !(sum > 0)) {
          definite_ = false;
          return;
        }
        at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
      }
  }

  bool is_definite() const { return definite_; }

  /// Returns x with A x = b.
  std::vector<double> solve(std::vector<double> b) const {
    for (int i = 0; i < n_; ++i) {
      for (int k = 0; k < i; ++k) b[i] -= at(i, k) * b[k];
      b[i] /= at(i, i);
    }
    for (int i = n_ - 1; i >= 0; --i) {
      for (int k = i + 1; k < n_; ++k) b[i] -= at(k, i) * b[k];
      b[i] /= at(i, i);
    }
    return b;
  }

  std::vector<double> inverse() const {
    std::vector<double> all(size_t(n_) * n_), unit(n_);
    for (int j = 0; j < n_; ++j) {
      unit.assign(n_, 0.0);
      unit[j] = 1;
      const std::vector<double> column = solve(unit);
      for (int i = 0; i < n_; ++i) all[i * n_ + j] = column[i];
    }
    return all;
  }

private:
  double& at(int i, int j) { return l_[i * n_ + j]; }
  double at(int i, int j) const { return l_[i * n_ + j]; }
  int n_;
  bool definite_ = true;
  std::vector<double> l_;
};

}  // namespace aureole::optics
