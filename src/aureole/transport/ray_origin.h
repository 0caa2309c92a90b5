// SPDX-License-Identifier: Apache-2.0
// `RayOrigin`: a point that rays leave or connections end at, with the bounds of its rounding error.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/emitter/emitter.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

/// Distance along the unit direction `d` from a plane to a point that lies `shift` off it, along its normal.
inline float distance_from_surface(const Vec3& shift, const Vec3& d) {
  constexpr float kMinCosine = 1 / 16.f;  // at grazing incidence a surface is no plane
  const float along = std::abs(dot(shift, d)), squared = length_squared(shift);
  return squared > 0 ? squared / std::max(along, kMinCosine * std::sqrt(squared)) : 0.f;
}

struct RayOrigin {
  Vec3 p;
  Vec3 p_error;  ///< bound of the rounding error of p; zero for a point that lies on no surface
  Vec3 ng;       ///< geometric normal; zero for a point that lies on no surface

  static RayOrigin of(const SurfacePoint& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin of(const DirectSample& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin of(const EmittedRay& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin in_space(const Vec3& p) { return {p, {}, {}}; }

  /// Returns the ray along the unit direction `d`, offset from the surface that the point lies on.
  Ray spawn(const Vec3& d) const { return {offset_origin(p, p_error, ng, d), d, kInfinity}; }
  /// Distance from the surface to the origin of a ray of unit direction that `spawn` has returned.
  float offset(const Ray& ray) const { return distance_from_surface(ray.o - p, ray.d); }
};

}  // namespace aureole
