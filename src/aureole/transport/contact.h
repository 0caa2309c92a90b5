// SPDX-License-Identifier: Apache-2.0
// `Contact`: surfaces that touch, as a ray hits them. A ray that hits one of them crosses all surfaces within
// the offset of its origin, since the next ray begins behind them. They count as one interface: from the body
// that fills the space before them to the one behind (optical contact), or none where both have the same
// index of refraction.
#pragma once

#include "aureole/scene/interior_list.h"
#include "aureole/scene/ray_tracer.h"

namespace aureole {

class Scene;
struct RayState;

struct Contact {
  /// the surface that acts as the interface; its rounding error bounds cover all touching surfaces
  SurfacePoint point;
  InteriorList across;             ///< the bodies around the ray once it has crossed all surfaces
  const Medium* medium = nullptr;  ///< medium behind all of the surfaces
  bool is_inactive = false;        ///< whether light passes unchanged
};

/// The medium behind an interface between two bodies, of which either may be missing; returns `around` where
/// neither body bounds a medium.
inline const Medium* medium_across(const InteriorList::Body& before, const InteriorList::Body& behind,
                                   const Medium* around) {
  if (behind.decides_medium()) return behind.surface->inside;
  return before.decides_medium() ? before.surface->outside : around;
}

/// Whether another surface that `touches` the hit one lies at the hit. `state` is the state of the ray, whose
/// direction need not have unit length.
bool find_contact(const Scene& scene, const Ray& ray, const RayTracer::Hit& hit, const RayState& state,
                  const Wavelengths& w, Contact& out);

}  // namespace aureole
