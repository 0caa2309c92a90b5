// SPDX-License-Identifier: Apache-2.0
// Affine (and for cameras projective) 4x4 transforms in double precision: scene files accumulate many of them
// and geometry is transformed once, at load.
#pragma once

#include <array>

#include "aureole/math/vec.h"

namespace aureole {

/// The largest coordinate of anything in a scene. Rays between any two places have origins and directions up to
/// twice that, which is what Embree takes, and sums of squares of coordinates stay within the range of float.
inline constexpr double kFarthestPlace = 9e17;

class Transform {
public:
  using Matrix = std::array<std::array<double, 4>, 4>;  ///< row-major, column vectors

  Transform();  ///< identity
  explicit Transform(const Matrix& m) : m_(m) {}

  static Transform translate(double x, double y, double z);
  static Transform scale(double x, double y, double z);
  /// Rotation by `degrees` about an axis of any length but zero.
  static Transform rotate(double x, double y, double z, double degrees);
  /// Camera-to-world with +z looking at `target`, as Mitsuba: x = up x direction (left-handed in the image
  /// plane). The result is singular (see `is_singular`) where up and direction are parallel or target =
  /// origin.
  static Transform look_at(const std::array<double, 3>& origin, const std::array<double, 3>& target,
                           const std::array<double, 3>& up);

  Transform operator*(const Transform& b) const;
  const Matrix& matrix() const { return m_; }
  double determinant3() const;  ///< of the upper-left 3x3 part
  bool is_singular() const;     ///< not invertible to working precision, or not finite
  /// The origin is moved no farther than to kFarthestPlace.
  bool stays_near() const;
  Transform inverse() const;  ///< requires !is_singular()

  Vec3 point(const Vec3& p) const;   ///< affine part only
  Vec3 vector(const Vec3& v) const;  ///< 3x3 part
  Vec3 normal(const Vec3& n) const;  ///< inverse-transpose 3x3 part, not normalised
  Vec2 point2(const Vec2& p) const;  ///< the x, y rows applied to (x, y, 0, 1): texture coordinates

  bool operator==(const Transform& b) const { return m_ == b.m_; }

private:
  Matrix m_;
};

}  // namespace aureole
