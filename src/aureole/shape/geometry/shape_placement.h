// SPDX-License-Identifier: Apache-2.0
// The placement of a shape that is defined by an equation: the affine map from local coordinates to world
// space and its inverse, in double precision.
#pragma once

#include "aureole/math/transform.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

class Placement {
public:
  /// Makes a placement by an invertible transform.
  explicit Placement(const Transform& t) {
    const auto &m = t.matrix(), i = t.inverse().matrix();
    for (int k = 0; k < 3; ++k) {
      column_[k] = {m[0][k], m[1][k], m[2][k]};
      row_[k] = {i[k][0], i[k][1], i[k][2]};
    }
    origin_ = {m[0][3], m[1][3], m[2][3]};
    double size = 0, inverse_size = 0;
    for (int k = 0; k < 3; ++k) size += length(column_[k]), inverse_size += length(row_[k]);
    // Bound of the error in local coordinates; the error of the inverse is proportional to the condition
    // number.
    in_double_ = 16 * 0x1p-53 * (size * std::max(1.0, size * inverse_size / 9) + length(origin_));
  }

  const Double3& origin() const { return origin_; }
  /// Returns the image of the k-th axis.
  const Double3& axis(int k) const { return column_[k]; }

  Double3 vector(const Double3& v) const { return column_[0] * v.x + column_[1] * v.y + column_[2] * v.z; }
  Double3 point(const Double3& p) const { return origin_ + vector(p); }
  /// Transforms a normal by the inverse transpose: it stays on its side of the surface, but its length may
  /// change.
  Double3 normal(const Double3& n) const { return row_[0] * n.x + row_[1] * n.y + row_[2] * n.z; }
  Double3 local_vector(const Double3& v) const { return {dot(row_[0], v), dot(row_[1], v), dot(row_[2], v)}; }
  Double3 local_point(const Double3& p) const { return local_vector(p - origin_); }
  bool mirrors() const { return dot(cross(column_[0], column_[1]), column_[2]) < 0; }

  /// Returns an upper bound of the rounding error of a point with local coordinates of at most 1, computed in
  /// double and rounded to float. It includes the error of the arithmetic of a ray that leaves the point.
  Vec3 rounding_error(const Vec3& p) const {
    const auto in_double = float(in_double_);
    return abs(p) * (2 * 0x1p-24f) + Vec3{in_double, in_double, in_double};
  }

private:
  Double3 column_[3], row_[3], origin_;
  double in_double_ = 0;
};

/// Returns the box [lower, upper], rounded outward.
inline Bounds3 outward_bounds(const Double3& lower, const Double3& upper) {
  const auto down = [](double x) { return std::nextafter(float(x), -kInfinity); };
  const auto up = [](double x) { return std::nextafter(float(x), kInfinity); };
  return {{down(lower.x), down(lower.y), down(lower.z)}, {up(upper.x), up(upper.y), up(upper.z)}};
}

}  // namespace aureole
