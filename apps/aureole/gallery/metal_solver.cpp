// SPDX-License-Identifier: Apache-2.0
#include "gallery/metal_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/gauss_legendre.h"

namespace aureole {
namespace {

using std::numbers::pi;
using Unknowns = std::vector<std::complex<double>>;

constexpr double kWaveNumber = 2 * pi;

/// Returns the solution of least squares of the rows of `matrix`, by the normal equations and Cholesky's factors.
Unknowns least_squares(const std::vector<Unknowns>& matrix, const Unknowns& right) {
  const std::size_t n = matrix.front().size();
  std::vector<Unknowns> lower(n, Unknowns(n));
  Unknowns x(n);
  for (std::size_t row = 0; row < matrix.size(); ++row)
    for (std::size_t i = 0; i < n; ++i) {
      const std::complex<double> a = std::conj(matrix[row][i]);
      x[i] += a * right[row];
      for (std::size_t j = 0; j <= i; ++j) lower[i][j] += a * matrix[row][j];
    }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      std::complex<double> sum = lower[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= lower[i][k] * std::conj(lower[j][k]);
      lower[i][j] = i == j ? std::sqrt(sum.real()) : sum / lower[j][j].real();
    }
    for (std::size_t k = 0; k < i; ++k) x[i] -= lower[i][k] * x[k];
    x[i] /= lower[i][i].real();
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= std::conj(lower[k][i]) * x[k];
    x[i] /= lower[i][i].real();
  }
  return x;
}

}  // namespace

MetalSolver::MetalSolver(const std::vector<MetalBlock>& blocks, double angle, bool is_hard,
                         int per_wavelength)
    : direction_{std::cos(angle), std::sin(angle)}, is_hard_(is_hard) {
  std::vector<Point> inside;
  for (const MetalBlock& b : blocks) {
    // Clockwise, so that normals on the left point outwards.
    const Point corners[] = {{b.x0, b.y1}, {b.x1, b.y1}, {b.x1, b.y0}, {b.x0, b.y0}};
    for (std::size_t side = 0; side < 4; ++side) {
      const Point &from = corners[side], &to = corners[(side + 1) % 4];
      const double size = std::hypot(to[0] - from[0], to[1] - from[1]);
      const int count = std::max(8, int(std::ceil(size * per_wavelength)));
      std::vector<double> cuts;
      for (const double near : {0.0, 0.02, 0.06, 0.15, 0.3, 0.55})
        cuts.push_back(near / count), cuts.push_back(1 - near / count);
      for (int i = 1; i < count; ++i) cuts.push_back(double(i) / count);
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const double part = cuts[i + 1] - cuts[i];
        const Point along{part * (to[0] - from[0]), part * (to[1] - from[1])};
        elements_.push_back({{from[0] + cuts[i] * (to[0] - from[0]), from[1] + cuts[i] * (to[1] - from[1])},
                             along,
                             {-(to[1] - from[1]) / size, (to[0] - from[0]) / size},
                             part * size});
      }
    }
    // Points of the additive recurrence whose steps are the powers of the plastic ratio's inverse: they lie nowhere on a
    // lattice of nodes of a resonance.
    const auto between = [](double low, double high, double t) {
      return low + (high - low) * (0.05 + 0.9 * (t - std::floor(t)));
    };
    const int points = 12 + int(2 * std::sqrt((b.x1 - b.x0) * (b.y1 - b.y0)));
    for (int i = 1; i <= points; ++i)
      inside.push_back({between(b.x0, b.x1, i * 0.7548776662), between(b.y0, b.y1, i * 0.5698402910)});
  }
  std::vector<Unknowns> matrix;
  Unknowns right;
  // Soft: the integral of G du/dn is the incident wave. Hard: u/2 minus the integral of u dG/dn is.
  const auto add = [&](const Point& p, std::size_t own) {
    Unknowns& row = matrix.emplace_back();
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      if (is_hard && i == own)
        row.push_back(0.5);
      else
        row.push_back((is_hard ? -1.0 : 1.0) * integral(p, elements_[i]));
    }
    right.push_back(incident(p));
  };
  for (std::size_t i = 0; i < elements_.size(); ++i) add(elements_[i].at(0.5), i);
  for (const Point& p : inside) add(p, elements_.size());
  unknown_ = least_squares(matrix, right);
}

std::complex<double> MetalSolver::incident(const Point& p) const {
  return std::polar(1.0, kWaveNumber * (p[0] * direction_[0] + p[1] * direction_[1]));
}

std::complex<double> MetalSolver::kernel(const Point& p, const Point& q, const Element& element) const {
  const double x = p[0] - q[0], y = p[1] - q[1], r = std::hypot(x, y);
  if (!is_hard_) return 0.25 * Complex(-::y0(kWaveNumber * r), ::j0(kWaveNumber * r));
  return 0.25 * kWaveNumber * (x * element.normal[0] + y * element.normal[1]) / r *
         Complex(-::y1(kWaveNumber * r), ::j1(kWaveNumber * r));
}

std::complex<double> MetalSolver::integral(const Point& p, const Element& element) const {
  static const optics::Quadrature far = optics::gauss_legendre(3, 0, 1),
                                  near = optics::gauss_legendre(6, 0, 1);
  const auto over = [&](const optics::Quadrature& rule, double from, double to) {
    Complex sum = 0;
    for (std::size_t i = 0; i < rule.x.size(); ++i)
      sum += rule.weight[i] * kernel(p, element.at(from + (to - from) * rule.x[i]), element);
    return sum * ((to - from) * element.length);
  };
  const double x = p[0] - element.begin[0], y = p[1] - element.begin[1];
  const double t =
      std::clamp((x * element.along[0] + y * element.along[1]) / (element.length * element.length), 0.0, 1.0);
  const Point nearest = element.at(t);
  if (std::hypot(p[0] - nearest[0], p[1] - nearest[1]) > 2 * element.length) return over(far, 0, 1);
  Complex sum = 0;
  constexpr double kRatio = 0.4;
  for (const double end : {0.0, 1.0}) {
    double to = end;
    for (int i = 0; i < 14 && to != t; ++i) {
      const double from = i == 13 ? t : t + (to - t) * kRatio;
      sum += over(near, std::min(from, to), std::max(from, to));
      to = from;
    }
  }
  return sum;
}

std::complex<double> MetalSolver::field(double x, double y) const {
  Complex scattered = 0;
  for (std::size_t i = 0; i < elements_.size(); ++i)
    scattered += unknown_[i] * integral({x, y}, elements_[i]);
  return incident({x, y}) + (is_hard_ ? scattered : -scattered);
}

}  // namespace aureole
