// SPDX-License-Identifier: Apache-2.0
// Scattering angles theta between directions that both point away from the point: theta = 0 where wo = -wi
// (forward). Narrow forward peaks and glories need angles of thousandths of a degree. The cosine of theta
// does not resolve them in single precision; 1 - cos(theta) and 1 + cos(theta) do.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/math/vec.h"
#include "aureole/math/warp.h"

namespace aureole {

inline float one_minus_cos(const Vec3& wi, const Vec3& wo) { return 0.5f * length_squared(wi + wo); }
inline float one_plus_cos(const Vec3& wi, const Vec3& wo) { return 0.5f * length_squared(wi - wo); }

/// Returns the direction at the angle theta from `axis` with 1 - cos(theta) = `one_minus_cos`, in [0, 2]. u
/// in [0, 1) sets the azimuth about the axis.
inline Vec3 turn_from(const Vec3& axis, float one_minus_cos, float u) {
  const float sine = std::sqrt(std::max(one_minus_cos * (2 - one_minus_cos), 0.f));
  const Vec2 a = cos_sin_2pi(u);
  return Frame::from_normal(axis).to_world({sine * a.x, sine * a.y, 1 - one_minus_cos});
}

}  // namespace aureole
