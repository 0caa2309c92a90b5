// SPDX-License-Identifier: Apache-2.0
// `SurfacePoint`: everything a plug-in may ask about a point on a surface.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "aureole/math/vec.h"

namespace aureole {

class Shape;

struct SurfacePoint {
  Vec3 p;
  Vec3 p_error;   ///< bound of the rounding error of p, per coordinate
  Vec3 ng;        ///< geometric normal, unit length; an area emitter shines on its side
  Frame shading;  ///< shading normal in n, s along dp/du
  Vec2 uv;
  const Shape* shape = nullptr;
  std::uint32_t primitive = 0;
  Vec2 barycentric;                 ///< Embree's (u, v) of the hit: weights of vertices 1 and 2 of a triangle
  const Shape* instance = nullptr;  ///< through which `shape` was met, if it belongs to a group
};

/// What the ray caster says of a hit.
struct ShapeHit {
  std::uint32_t geometry = 0;  ///< within a group of shapes that is instanced; else 0
  std::uint32_t primitive = 0;
  float u = 0, v = 0, t = 0;
};

/// Derivatives of the position by the texture coordinates, in the world; zero where uv do not vary.
struct SurfaceDerivatives {
  Vec3 dp_du, dp_dv;
};

namespace detail {
/// The next float beyond x in the direction of the sign of `towards`; x itself where that is zero.
inline float step_towards(float x, float towards) {
  if (towards == 0) return x;
  if (x == 0) return std::copysign(std::numeric_limits<float>::denorm_min(), towards);
  const std::int32_t away_from_zero = (x > 0) == (towards > 0) ? 1 : -1;
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(x) + away_from_zero);
}
}  // namespace detail

/// The bound n u / (1 - n u) on the relative error of n roundings (Pharr, Jakob & Humphreys 2023, eq. 6.16).
constexpr float gamma_bound(int n) {
  constexpr float kHalfUlp = 0x1p-24f;
  return n * kHalfUlp / (1 - n * kHalfUlp);
}

/// Origin for a ray leaving `point` along `d`: moved along the geometric normal just beyond the error bound,
/// so that the ray cannot meet the surface it starts from (Pharr, Jakob & Humphreys 2023, "Physically Based
/// Rendering", section 6.8.6).
inline Vec3 offset_origin(const Vec3& p, const Vec3& p_error, const Vec3& ng, const Vec3& d) {
  const float distance = dot(abs(ng), p_error);
  const Vec3 offset = dot(d, ng) < 0 ? ng * -distance : ng * distance;
  // The sum is rounded to nearest: step once more, away from the surface.
  return {detail::step_towards(p.x + offset.x, offset.x), detail::step_towards(p.y + offset.y, offset.y),
          detail::step_towards(p.z + offset.z, offset.z)};
}
inline Vec3 offset_origin(const SurfacePoint& s, const Vec3& d) {
  return offset_origin(s.p, s.p_error, s.ng, d);
}

}  // namespace aureole
