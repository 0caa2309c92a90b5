// SPDX-License-Identifier: Apache-2.0
// Waves of points in a periodic box, for sums over many points and many waves.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace aureole::test {

/// exp(i q.x) of each point, for waves with the period of a box: products of the powers of two phasors of a point, which
/// are multiplied up once for all waves.
class Phasors {
public:
  Phasors(const std::vector<double>& x, const std::vector<double>& y, double box)
      : n_(x.size()), step_(2 * std::numbers::pi / box) {
    const int most = int(std::ceil(6.5 / step_));
    add_powers(x, most, along_x_);
    add_powers(y, most, along_y_);
  }
  /// A function of the point's number.
  auto of(double qx, double qy) const {
    const long m = std::lround(qx / step_), n = std::lround(qy / step_);
    return [x = &along_x_[std::size_t(std::abs(m)) * n_], y = &along_y_[std::size_t(std::abs(n)) * n_],
            u = m < 0 ? -1.0 : 1.0, v = n < 0 ? -1.0 : 1.0](std::size_t i) {
      const double a = x[i].real(), b = u * x[i].imag(), c = y[i].real(), d = v * y[i].imag();
      return std::complex<double>(a * c - b * d, a * d + b * c);
    };
  }

private:
  using Powers = std::vector<std::complex<double>>;  // of all points, from the power 0 on
  void add_powers(const std::vector<double>& x, int most, Powers& out) const {
    for (int m = 0; m <= most; ++m)
      for (std::size_t i = 0; i < n_; ++i) {
        if (m < 2) {
          out.push_back(std::polar(1.0, m * step_ * x[i]));
          continue;
        }
        const std::complex<double> a = out[out.size() - n_], b = out[n_ + i];
        out.emplace_back(a.real() * b.real() - a.imag() * b.imag(),
                         a.real() * b.imag() + a.imag() * b.real());
      }
  }

  std::size_t n_;
  double step_;
  Powers along_x_, along_y_;
};

}  // namespace aureole::test
