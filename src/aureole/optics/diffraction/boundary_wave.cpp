// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/boundary_wave.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "aureole/optics/faddeeva.h"
#include "aureole/optics/gauss_legendre.h"
#include "aureole/optics/lanes.h"

namespace aureole::optics {

namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// Returns the corner wave over exp(i pi r^2/2), which is a smooth function. The integral over x = tan(phi)
/// is deformed into the complex plane, x^2 = tan^2(psi) + i t/a with a = pi v^2/2, where the integrand falls
/// as exp(-t); s = sqrt(t).
Complex smooth_corner(double r, double psi) {
  if (r == 0) return (pi / 2 - psi) / (2 * pi);
  // Near psi = pi/2 the line runs along the radius: the remaining angle is small, and so is the wave.
  const double cosine = std::cos(psi);
  const double a = pi / 2 * r * r * cosine * cosine;
  if (a == 0) return 0;
  const double x0 = std::tan(psi), y0 = 1 / (cosine * cosine);
  static const Quadrature rule = gauss_legendre(12, 0, 1);
  // The integrand changes its behaviour where s is sqrt(a) tan(psi), sqrt(a) or 1: cells grow by a constant
  // ratio up to s = kEnd, where exp(-s^2) is negligible.
  Complex sum = 0;
  constexpr double kEnd = 6.5;
  double from = 0, to = std::min(kEnd / 2, 0.25 * std::sqrt(a) * std::clamp(x0, 1e-3, 1.0));
  while (from < kEnd) {
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double s = from + (to - from) * rule.x[i];
      const Complex it(0, s * s / a);
      sum += rule.weight[i] * (to - from) * std::exp(-s * s) * s / (std::sqrt(x0 * x0 + it) * (y0 + it));
    }
    from = to, to = std::min(kEnd, to * 2);
  }
  return Complex(0, 1) * sum / (a * 2 * pi);
}

/// `smooth_corner` on a grid of x = r/(1 + r) and w, where psi = (pi/2) w^2: near psi = 0 it changes within
/// an angle of 1/r.
class CornerTable {
public:
  CornerTable() : values_(kRows * kColumns) {
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kColumns; ++j) {
        const double x = double(i) / (kRows - 1);
        const double w = double(j) / (kColumns - 1), psi = pi / 2 * w * w;
        // At r = infinity `smooth_corner` is 0.
        values_[std::size_t(i * kColumns + j)] =
            i == kRows - 1 ? Complex(0) : smooth_corner(x / (1 - x), psi);
      }
  }
  /// The four columns of the table about an angle, with their weights, which do not depend on r.
  class Column {
  public:
    Column(const CornerTable& table, double psi) : table_(table) {
      const double y = std::sqrt(psi / (pi / 2)) * (kColumns - 1);
      first_ = std::clamp(int(y) - 1, 0, kColumns - 4);
      const auto q = weights(y - first_);
      low_ = Lanes{q[0], q[0], q[1], q[1]}, high_ = Lanes{q[2], q[2], q[3], q[3]};
    }
    Complex at(double r) const {
      const double x = r / (1 + r) * (kRows - 1);
      const int i = std::clamp(int(x) - 1, 0, kRows - 4);
      const auto p = weights(x - i);
      Lanes sum{};
      for (int k = 0; k < 4; ++k) {
        const auto* row =
            reinterpret_cast<const double*>(&table_.values_[std::size_t((i + k) * kColumns + first_)]);
        sum += p[std::size_t(k)] * (low_ * load_lanes(row) + high_ * load_lanes(row + 4));
      }
      return {sum[0] + sum[2], sum[1] + sum[3]};
    }

  private:
    const CornerTable& table_;
    int first_;
    Lanes low_, high_;  ///< weights of two columns each, for real and imaginary parts
  };

private:
  static constexpr int kRows = 129, kColumns = 97;

  /// Returns the weights of Lagrange's cubic interpolation at t through the points 0, 1, 2, 3.
  static std::array<double, 4> weights(double t) {
    const double a = t, b = t - 1, c = t - 2, d = t - 3;
    return {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6};
  }
  std::vector<Complex> values_;
};

Complex wave_factor(double v) { return std::polar(1.0, pi / 2 * v * v); }

const CornerTable& corner_table() {
  static const CornerTable table;
  return table;
}

/// The inverses of up to kLanes wavelengths; unused lanes repeat the last wavelength.
struct WavelengthLanes {
  WavelengthLanes(std::span<const double> wavelengths)
      : count(int(std::min<std::size_t>(kLanes, wavelengths.size()))) {
    for (int i = 0; i < kLanes; ++i) inverse[i] = 1 / wavelengths[std::size_t(std::min(i, count - 1))];
  }
  int count;
  Lanes inverse;
};

/// Adds the wave of a half line whose end has the distance `radius` from the axis and the azimuth `psi` from
/// the foot of the perpendicular.
void add_half_line(double factor, double radius, double psi, std::span<const double> wavelengths,
                   double window, Complex* sum) {
  const CornerTable::Column column(corner_table(), psi);
  for (std::size_t from = 0; from < wavelengths.size(); from += kLanes) {
    const WavelengthLanes lanes(wavelengths.subspan(from));
    Lanes sine, cosine;
    sine_cosine(lanes.inverse * (pi / 2 * radius * radius), sine, cosine);
    for (int i = 0; i < lanes.count; ++i) {
      const double r = radius * std::sqrt(lanes.inverse[i]);
      const double weight = factor * window_weight(r, window);
      if (weight != 0) sum[from + std::size_t(i)] += weight * Complex(cosine[i], sine[i]) * column.at(r);
    }
  }
}

}  // namespace

Complex corner_wave(double r, double psi) {
  return wave_factor(r) * CornerTable::Column(corner_table(), psi).at(r);
}

Complex corner_wave_by_quadrature(double r, double psi) { return wave_factor(r) * smooth_corner(r, psi); }

Complex two_edges_field(double v1, double v2, double rho) {
  const auto away_from_zero = [](double v) { return std::copysign(std::max(std::abs(v), 1e-6), v); };
  v1 = away_from_zero(v1), v2 = away_from_zero(v2);
  rho = std::clamp(rho, -1 + 1e-12, 1 - 1e-12);
  const double root = std::sqrt((1 - rho) * (1 + rho));
  // Owen's T(h, a) with h^2 = -i pi v^2.
  const auto owen = [](double v, double a) {
    const double r = std::abs(v) * std::hypot(1, a);
    const Complex wave = 0.5 * knife_edge_field(-std::abs(v)) - corner_wave(r, std::atan(std::abs(a)));
    return a < 0 ? -wave : wave;
  };
  return 0.5 * (knife_edge_field(v1) + knife_edge_field(v2)) - owen(v1, (v2 / v1 - rho) / root) -
         owen(v2, (v1 / v2 - rho) / root) - (v1 * v2 < 0 ? 0.5 : 0.0);
}

Complex wave_past_edge(double v, double w, double along) {
  // Where both parameters vanish, their ratio matters.
  v = std::max(std::abs(v), 1e-12);
  const double both = std::hypot(v, w);
  Complex factor = 0;
  if (along > 0) {
    const Complex shadowed = corner_wave(both, std::atan(std::abs(w) / v)) / knife_edge_field(-v);
    factor += along * (w < 0 ? shadowed : 1.0 - shadowed);
  }
  // A short piece of the first edge, in one direction from the segment: the integral over its distance s v, s
  // >= 1, of the wave there times the knife edge's field at s w.
  if (along < 1)
    factor +=
        (1 - along) * (knife_edge_field(w) + w / both * knife_edge_field(-both) * std::conj(wave_factor(v)));
  return factor;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double window_weight(double v, double window) { return 1 - smooth_step((std::abs(v) / window - 1) * 3); }

BoundaryPiece::BoundaryPiece(PlanePoint begin, PlanePoint end, PieceObliquity c) : c_middle_(c.middle) {
  double across = begin.x * end.y - begin.y * end.x;
  if (across < 0) {
    std::swap(begin, end), std::swap(c.begin, c.end);
    across = -across;
  }
  const double x = end.x - begin.x, y = end.y - begin.y, size = std::sqrt(x * x + y * y);
  foot_ = size > 0 ? across / size : std::hypot(begin.x, begin.y);
  const auto set = [&](int i, PlanePoint p, double obliquity) {
    radius_[i] = std::sqrt(p.x * p.x + p.y * p.y);
    const double along = size > 0 ? (p.x * x + p.y * y) / size : 0;
    psi_[i] = std::atan2(along, foot_);
    c_[i] = obliquity;
  };
  set(0, begin, c.begin), set(1, end, c.end);
}

int BoundaryPiece::nodes(double wavelength) const {
  const double a = radius_[0] * radius_[0], b = radius_[1] * radius_[1];
  const bool has_foot = psi_[0] < 0 && psi_[1] > 0;
  const double most = std::max(a, b), least = has_foot ? foot_ * foot_ : std::min(a, b);
  // About the foot the phase falls and rises again: such a piece needs as many nodes as one without a foot
  // whose phase changes five times as much.
  const double phase = pi / 2 * (most - least) / wavelength * (has_foot ? 5 : 1);
  if (most < 1.1 * least && phase < 1) return 3;
  if (most < 1.3 * least) return phase < 3 ? 5 : phase < 8 ? 8 : 0;
  return 0;
}

void BoundaryPiece::add_by_rule(int nodes, double factor, std::span<const double> wavelengths, double window,
                                Complex* sum) const {
  static const Quadrature kRules[] = {gauss_legendre(3), gauss_legendre(5), gauss_legendre(8)};
  const Quadrature& rule = kRules[nodes == 3 ? 0 : nodes == 5 ? 1 : 2];
  const double half = 0.5 * (psi_[1] - psi_[0]), middle = 0.5 * (psi_[0] + psi_[1]);
  const double scale = factor * half / (2 * pi) * 0.5 * (c_[0] + c_[1]);
  std::array<double, 8> squares;
  for (std::size_t k = 0; k < rule.x.size(); ++k) {
    const double cosine = std::cos(middle + rule.x[k] * half);
    squares[k] = foot_ * foot_ / (cosine * cosine);
  }
  const double radius = 0.5 * (radius_[0] + radius_[1]);
  for (std::size_t from = 0; from < wavelengths.size(); from += kLanes) {
    const WavelengthLanes lanes(wavelengths.subspan(from));
    Lanes real{}, imaginary{};
    for (std::size_t k = 0; k < rule.x.size(); ++k) {
      Lanes sine, cosine;
      sine_cosine(lanes.inverse * (pi / 2 * squares[k]), sine, cosine);
      real += rule.weight[k] * cosine, imaginary += rule.weight[k] * sine;
    }
    for (int i = 0; i < lanes.count; ++i) {
      const double weight = scale * window_weight(radius * std::sqrt(lanes.inverse[i]), window);
      sum[from + std::size_t(i)] += Complex(weight * real[i], weight * imaginary[i]);
    }
  }
}

void BoundaryPiece::add(double factor, std::span<const double> wavelengths, double window,
                        Complex* sum) const {
  if (const int n = nodes(*std::min_element(wavelengths.begin(), wavelengths.end())); n > 0)
    return add_by_rule(n, factor, wavelengths, window, sum);
  // The wave of an infinite line is the sum of the waves of its two halves.
  if (psi_[0] < 0 && psi_[1] >= 0) add_half_line(2 * factor * c_middle_, foot_, 0, wavelengths, window, sum);
  for (int i = 0; i < 2; ++i) {
    // The wave between the foot and an end is that of the half line from the foot minus that of the half line
    // beyond the end; psi = 0 counts as psi > 0.
    const double sign = (psi_[i] >= 0 ? 1 : -1) * (i == 1 ? 1 : -1);
    add_half_line(-sign * factor * c_[i], radius_[i], std::min(std::abs(psi_[i]), pi / 2), wavelengths,
                  window, sum);
  }
}

}  // namespace aureole::optics
