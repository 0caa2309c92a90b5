// SPDX-License-Identifier: Apache-2.0
// `Anchor`: where a ray leaves or a connection ends.
#pragma once

#include "aureole/emitter/emitter.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

struct Anchor {
  Vec3 p;
  Vec3 p_error;  ///< bound of the rounding error of p; zero for a point that lies on no surface
  Vec3 ng;       ///< geometric normal; zero for a point that lies on no surface

  static Anchor of(const SurfacePoint& s) { return {s.p, s.p_error, s.ng}; }
  static Anchor of(const DirectSample& s) { return {s.p, s.p_error, s.ng}; }
  static Anchor of(const EmittedRay& s) { return {s.p, s.p_error, s.ng}; }
  static Anchor in_space(const Vec3& p) { return {p, {}, {}}; }

  /// The ray that leaves along the unit direction `d`.
  Ray leave(const Vec3& d) const { return {offset_origin(p, p_error, ng, d), d, kInfinity}; }
};

}  // namespace aureole
