// SPDX-License-Identifier: Apache-2.0
// Normals of a surface with Gaussian slopes (Beckmann's distribution): all normals, not only those visible
// from a direction.
#pragma once

#include <cmath>

#include "aureole/math/warp.h"

namespace aureole {

struct Beckmann {
  float alpha_u, alpha_v;  ///< sqrt(2) times the standard deviation of the slope along each tangent

  /// Density of normals [1/sr], m.z > 0: the integral of D cos(theta_m) over the hemisphere is one.
  float d(const Vec3& m) const {
    const float x = m.x / alpha_u, y = m.y / alpha_v, c2 = m.z * m.z, e = x * x + y * y;
    // Beyond this bound the exponential is zero in single precision, and the powers of the cosine may be zero
    // as well.
    if (!(e < 87 * c2)) return 0;
    return std::exp(-e / c2) * kInvPi / (alpha_u * alpha_v * c2 * c2);
  }
  /// Samples a normal with density D cos(theta_m).
  Vec3 sample(Vec2 u) const {
    const float r = std::sqrt(-std::log(1 - u.x));
    const Vec2 a = cos_sin_2pi(u.y);
    return normalize(Vec3{alpha_u * r * a.x, alpha_v * r * a.y, 1});
  }
};

}  // namespace aureole
