// SPDX-License-Identifier: Apache-2.0
// Microflakes: tiny mirrors whose normals are distributed as those of an ellipsoid (Heitz, Dupuy, Crassin &
// Dachsbacher 2015, "The SGGX microflake distribution"). The symmetric, positive definite matrix S gives the
// ellipsoid's projected area along the unit vector w, a(w) = sqrt(w^T S w). The density of normals is
//     D(n) = 1/(pi sqrt(det S) (n^T S^-1 n)^2).
#pragma once

#include <array>
#include <cmath>

#include "aureole/math/vec.h"
#include "aureole/math/warp.h"

namespace aureole {

class Flakes {
public:
  /// Takes the entries xx, yy, zz, xy, xz, yz of S. A matrix that is not positive definite is replaced by the
  /// multiple of the unit matrix with its trace, and the zero matrix of empty space by the unit matrix.
  explicit Flakes(const std::array<float, 6>& s) {
    if (factorize(s)) return;
    const float mean = (s[0] + s[1] + s[2]) / 3;
    const float size = mean > kMinEigenvalue ? mean : 1;
    factorize({size, size, size, 0, 0, 0});
  }

  /// Whether these entries of S form a positive definite matrix that can be inverted in single precision.
  static bool is_valid(const std::array<float, 6>& s) {
    Flakes f;
    return f.factorize(s);
  }

  float area(const Vec3& w) const { return length(to_sphere(w)); }

  /// Returns the phase function [1/sr], which is also the pdf of `sample`: D(h)/(4 a(wi)) with the half
  /// vector h of wi and wo (Heitz et al. 2015, specular phase function).
  float eval(const Vec3& wi, const Vec3& wo) const {
    // Computes n^T S^-1 n for n = (wi + wo)/|wi + wo|. In the forward direction (wi = -wo) there is no half
    // vector.
    const Vec3 sum = wi + wo, m = solve(sum);
    const float l2 = length_squared(sum), m2 = length_squared(m);
    if (!(m2 > 0)) return 0;
    const float ratio = l2 / m2;
    return 0.25f * kInvPi * ratio * ratio / (determinant_root_ * area(wi));
  }

  /// Samples a direction by reflecting wi in a visible normal. L maps the unit sphere to the ellipsoid; on a
  /// sphere, visible normals have a cosine density.
  Vec3 sample(const Vec3& wi, Vec2 u) const {
    const Vec3 along = normalize(to_sphere(wi));
    const Vec3 n = normalize(from_sphere(Frame::from_normal(along).to_world(square_to_cosine_hemisphere(u))));
    return normalize(n * (2 * dot(wi, n)) - wi);
  }

private:
  static constexpr float kMinEigenvalue = 1e-12f;

  Flakes() = default;

  /// Computes the Cholesky factorisation S = L L^T. Returns false if it fails.
  bool factorize(const std::array<float, 6>& s) {
    // Smallest pivot relative to its diagonal entry: a smaller one is only rounding error and would spoil the
    // inverse.
    constexpr float kRounding = 1e-5f;
    if (!(s[0] > kMinEigenvalue)) return false;
    xx_ = std::sqrt(s[0]);
    yx_ = s[3] / xx_, zx_ = s[4] / xx_;
    const float yy = s[1] - yx_ * yx_;
    if (!(yy > kRounding * s[1]) || !(s[1] > kMinEigenvalue)) return false;
    yy_ = std::sqrt(yy);
    zy_ = (s[5] - zx_ * yx_) / yy_;
    const float zz = s[2] - zx_ * zx_ - zy_ * zy_;
    if (!(zz > kRounding * s[2]) || !(s[2] > kMinEigenvalue)) return false;
    zz_ = std::sqrt(zz);
    determinant_root_ = xx_ * yy_ * zz_;
    return std::isfinite(determinant_root_) && determinant_root_ > 0;
  }

  /// Returns L^T w.
  Vec3 to_sphere(const Vec3& w) const {
    return {xx_ * w.x + yx_ * w.y + zx_ * w.z, yy_ * w.y + zy_ * w.z, zz_ * w.z};
  }
  /// L m
  Vec3 from_sphere(const Vec3& m) const {
    return {xx_ * m.x, yx_ * m.x + yy_ * m.y, zx_ * m.x + zy_ * m.y + zz_ * m.z};
  }
  /// Returns L^-1 n.
  Vec3 solve(const Vec3& n) const {
    const float x = n.x / xx_, y = (n.y - yx_ * x) / yy_;
    return {x, y, (n.z - zx_ * x - zy_ * y) / zz_};
  }

  float xx_ = 0, yx_ = 0, yy_ = 0, zx_ = 0, zy_ = 0, zz_ = 0;  // L
  float determinant_root_ = 0;
};

}  // namespace aureole
