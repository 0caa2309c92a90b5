// SPDX-License-Identifier: Apache-2.0
// `RayOrigin`: a point that rays leave or connections end at, with the bounds of its rounding error.
#pragma once

#include "aureole/emitter/emitter.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

struct RayOrigin {
  Vec3 p;
  Vec3 p_error;  ///< bound of the rounding error of p; zero for a point that lies on no surface
  Vec3 ng;       ///< geometric normal; zero for a point that lies on no surface

  static RayOrigin of(const SurfacePoint& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin of(const DirectSample& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin of(const EmittedRay& s) { return {s.p, s.p_error, s.ng}; }
  static RayOrigin in_space(const Vec3& p) { return {p, {}, {}}; }

  /// The ray that leaves along the unit direction `d`, off the surface that the point lies on.
  Ray spawn(const Vec3& d) const { return {offset_origin(p, p_error, ng, d), d, kInfinity}; }
  /// Distance along a ray of unit direction that `spawn` has given from the point to its origin.
  float offset(const Ray& ray) const { return dot(ray.o - p, ray.d); }
};

}  // namespace aureole
