// SPDX-License-Identifier: Apache-2.0
// The zero of a function that is trilinear between the eight corners of a unit cube. Along a ray the function
// is a cubic (Hansson-Soderlund, Evans & Akenine-Moller 2022, "Ray tracing of signed distance function
// grids", JCGT 11(3)).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// The cubic polynomial c[0] + c[1] s + c[2] s^2 + c[3] s^3.
struct Cubic {
  std::array<double, 4> c;

  double at(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
  double slope_at(double s) const { return c[1] + s * (2 * c[2] + s * 3 * c[3]); }
  /// Returns the first s in [0, 1] at which the sign changes; zero counts as positive.
  std::optional<double> first_crossing() const;

private:
  static bool is_inside(double f) { return f < 0; }
  /// Returns the crossing in [a, b]. The signs at a and b differ, and the cubic has no turning point between
  /// them.
  double crossing_between(double a, double b) const;
};

inline std::optional<double> Cubic::first_crossing() const {
  double ends[4] = {0};
  int count = 1;
  const auto add = [&](double s) {
    if (s > ends[count - 1] && s < 1) ends[count++] = s;
  };
  // Turning points of the cubic, by the quadratic formula without cancellation.
  const double a = 3 * c[3], half_b = c[2], discriminant = half_b * half_b - a * c[1];
  if (discriminant > 0) {
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    const double one = a != 0 ? q / a : 2, other = q != 0 ? c[1] / q : 2;
    add(std::min(one, other)), add(std::max(one, other));
  }
  ends[count++] = 1;
  bool inside = is_inside(at(0));
  for (int i = 1; i < count; ++i)
    if (is_inside(at(ends[i])) != inside) return crossing_between(ends[i - 1], ends[i]);
  return {};
}

inline double Cubic::crossing_between(double a, double b) const {
  const bool inside = is_inside(at(a));
  double s = a + (b - a) * at(a) / (at(a) - at(b));
  // The root is found by Newton's method, with bisection where a step leaves the interval or converges
  // slowly.
  for (int i = 0; i < 100 && b - a > 1e-15; ++i) {
    if (!(s > a && s < b)) s = 0.5 * (a + b);
    const double f = at(s);
    (is_inside(f) == inside ? a : b) = s;
    const double step = f / slope_at(s);
    if (std::abs(step) < 1e-15) break;
    s -= i % 8 == 7 ? s - 0.5 * (a + b) : step;
  }
  return std::clamp(s, a, b);
}

class TrilinearCell {
public:
  /// Makes a cell; `corner` is indexed by x + 2 y + 4 z.
  explicit TrilinearCell(const std::array<double, 8>& corner) : f_(corner) {
    x_ = f_[1] - f_[0], y_ = f_[2] - f_[0], z_ = f_[4] - f_[0];
    xy_ = f_[3] - f_[2] - x_, yz_ = f_[6] - f_[4] - y_, xz_ = f_[5] - f_[4] - x_;
    xyz_ = f_[7] - f_[6] - f_[5] + f_[4] - xy_;
  }

  double at(const Double3& p) const {
    return f_[0] + p.x * (x_ + p.y * (xy_ + p.z * xyz_)) + p.y * (y_ + p.z * yz_) + p.z * (z_ + p.x * xz_);
  }
  Double3 gradient(const Double3& p) const {
    return {x_ + p.y * (xy_ + p.z * xyz_) + p.z * xz_, y_ + p.x * (xy_ + p.z * xyz_) + p.z * yz_,
            z_ + p.x * (xz_ + p.y * xyz_) + p.y * yz_};
  }
  /// Returns the function along the ray p + d s.
  Cubic along(const Double3& p, const Double3& d) const {
    const Double3 g = gradient(p);
    const double dxy = d.x * d.y, dyz = d.y * d.z, dxz = d.x * d.z;
    return {{at(p), dot(g, d), xy_ * dxy + yz_ * dyz + xz_ * dxz + xyz_ * (p.x * dyz + p.y * dxz + p.z * dxy),
             xyz_ * dxy * d.z}};
  }

private:
  std::array<double, 8> f_;
  double x_, y_, z_, xy_, yz_, xz_, xyz_;
};

}  // namespace aureole
