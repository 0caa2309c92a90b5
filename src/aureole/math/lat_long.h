// SPDX-License-Identifier: Apache-2.0
// The latitude-longitude projection of directions, in which environment maps are stored and panoramas are taken.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/math/vec.h"
#include "aureole/math/warp.h"

namespace aureole {

/// Returns the direction of a point of the map: y is up, u = 0 is the direction -z, and u grows towards +x; v
/// = 0 is up.
inline Vec3 lat_long_direction(Vec2 uv) {
  const Vec2 phi = cos_sin_2pi(uv.x), theta = cos_sin_2pi(0.5f * uv.y);
  return {phi.y * theta.y, theta.x, -phi.x * theta.y};
}

/// Returns the point of the map, in [0, 1]^2, of a unit direction.
inline Vec2 lat_long_uv(const Vec3& d) {
  const float u = std::atan2(d.x, -d.z) * (0.5f * kInvPi);
  return {u < 0 ? u + 1 : u, std::acos(std::clamp(d.y, -1.f, 1.f)) * kInvPi};
}

}  // namespace aureole
