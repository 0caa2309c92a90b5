// SPDX-License-Identifier: Apache-2.0
// A double-precision vector for computations in which cancellation in float would be too large: solid angles,
// quadratic equations, transforms at load time.
#pragma once

#include <cmath>

#include "aureole/math/vec.h"

namespace aureole {

struct Double3 {
  double x = 0, y = 0, z = 0;
  Double3() = default;
  Double3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Double3(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}
  Vec3 to_float() const { return {float(x), float(y), float(z)}; }
};
inline Double3 operator+(const Double3& a, const Double3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Double3 operator-(const Double3& a, const Double3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Double3 operator-(const Double3& a) { return {-a.x, -a.y, -a.z}; }
inline Double3 operator*(const Double3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline Double3 operator*(double s, const Double3& a) { return a * s; }
inline double dot(const Double3& a, const Double3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Double3 cross(const Double3& a, const Double3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Double3& a) { return std::sqrt(dot(a, a)); }
inline Double3 normalize(const Double3& a) { return a * (1 / length(a)); }
/// Makes a right-handed pair of unit vectors perpendicular to the unit vector n (Duff et al. 2017, "Building
/// an orthonormal basis, revisited").
inline void make_basis(const Double3& n, Double3& s, Double3& t) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace aureole
