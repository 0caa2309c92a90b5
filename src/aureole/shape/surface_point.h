// SPDX-License-Identifier: Apache-2.0
// `SurfacePoint`: all data of a point on a surface that plug-ins may use.
#pragma once

#include <cstdint>

#include "aureole/math/vec.h"

namespace aureole {

class Instance;
class Shape;
struct Surface;

struct SurfacePoint {
  Vec3 p;
  Vec3 p_error;   ///< upper bound of the rounding error of p, per coordinate
  Vec3 ng;        ///< geometric normal, unit length; an area emitter emits on that side
  Frame shading;  ///< shading normal in n, s along dp/du
  Vec2 uv;
  const Shape* shape = nullptr;
  /// the surface's record in the scene (scene/surface.h); null outside of a scene
  const Surface* surface = nullptr;
  std::uint32_t primitive = 0;
  Vec2 barycentric;  ///< Embree's (u, v) of the hit: weights of vertices 1 and 2 of a triangle
  float time = 0;    ///< [s], of a hit on an instance that moves
  const Instance* instance = nullptr;  ///< instance through which `shape` was hit, if it belongs to a group
};

/// A hit as reported by the ray caster.
struct ShapeHit {
  std::uint32_t geometry = 0;  ///< index within an instanced group of shapes; else 0
  std::uint32_t primitive = 0;
  float u = 0, v = 0, t = 0;
};

/// Derivatives of the position with respect to the texture coordinates, in world space; zero where uv are
/// constant.
struct SurfaceDerivatives {
  Vec3 dp_du, dp_dv;
};

/// The bound n u / (1 - n u) on the relative error of n roundings (Pharr, Jakob & Humphreys 2023, eq. 6.16).
constexpr float gamma_bound(int n) {
  constexpr float kHalfUlp = 0x1p-24f;
  return n * kHalfUlp / (1 - n * kHalfUlp);
}

/// Returns the origin of a ray leaving `point` along `d`: moved along the geometric normal just beyond the
/// error bound, so that the ray cannot hit its own surface (Pharr, Jakob & Humphreys 2023, "Physically Based
/// Rendering", section 6.8.6).
inline Vec3 offset_origin(const Vec3& p, const Vec3& p_error, const Vec3& ng, const Vec3& d) {
  // Distance of the offset; the rounding of the sum itself is included.
  const float distance = dot(abs(ng), p_error + abs(p) * 0x1p-23f);
  return p + ng * (dot(d, ng) < 0 ? -distance : distance);
}
/// Distance from the surface of the origin that `offset_origin` returns.
inline float offset_distance(const SurfacePoint& s) {
  return dot(abs(s.ng), s.p_error + abs(s.p) * 0x1p-23f);
}
inline Vec3 offset_origin(const SurfacePoint& s, const Vec3& d) {
  return offset_origin(s.p, s.p_error, s.ng, d);
}

}  // namespace aureole
