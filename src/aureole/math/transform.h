// SPDX-License-Identifier: Apache-2.0
// Affine (for cameras also projective) 4x4 transforms in double precision: scene files combine many of them,
// and geometry is transformed only once, when it is loaded.
#pragma once

#include <array>

#include "aureole/math/vec.h"

namespace aureole {

/// Upper bound of all coordinates in a scene. Ray origins and directions between two points are at most twice
/// that, which is Embree's limit, and sums of squares of coordinates stay within the range of float.
inline constexpr double kFarthestPlace = 9e17;

class Transform {
public:
  /// rows of the matrix, which multiplies column vectors
  using Matrix = std::array<std::array<double, 4>, 4>;

  Transform();  ///< identity
  explicit Transform(const Matrix& m) : m_(m) {}

  static Transform translate(double x, double y, double z);
  static Transform scale(double x, double y, double z);
  /// Rotation by `degrees` about an axis of any nonzero length.
  static Transform rotate(double x, double y, double z, double degrees);
  /// Camera-to-world transform whose +z points to `target`, as in Mitsuba: x = up x direction (left-handed in
  /// the image plane). It is singular (see `is_singular`) if up and direction are parallel or if target =
  /// origin.
  static Transform look_at(const std::array<double, 3>& origin, const std::array<double, 3>& target,
                           const std::array<double, 3>& up);

  Transform operator*(const Transform& b) const;
  const Matrix& matrix() const { return m_; }
  double determinant3() const;  ///< determinant of the upper left 3x3 submatrix
  bool is_singular() const;     ///< whether the matrix is not invertible to working precision, or not finite
  /// Whether the origin is mapped to coordinates of at most kFarthestPlace.
  bool stays_near() const;
  Transform inverse() const;  ///< returns the inverse; requires !is_singular()
  /// Returns the rotation nearest to the 3x3 submatrix, or the nearest rotation with a reflection if the
  /// submatrix mirrors: the orthogonal factor of the polar decomposition. Requires !is_singular().
  Transform orthogonal_part() const;

  Vec3 point(const Vec3& p) const;   ///< applies the affine part only
  Vec3 vector(const Vec3& v) const;  ///< applies the 3x3 submatrix
  /// applies the inverse transpose of the 3x3 submatrix; the result is not normalised
  Vec3 normal(const Vec3& n) const;
  Vec2 point2(const Vec2& p) const;  ///< applies the x, y rows to (x, y, 0, 1), for texture coordinates

  bool operator==(const Transform& b) const { return m_ == b.m_; }

private:
  Matrix m_;
};

}  // namespace aureole
