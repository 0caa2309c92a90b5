// SPDX-License-Identifier: Apache-2.0
// `RayState`: a ray with the medium and the shapes that its origin lies in; and `Segment`, which also knows
// the origin of the straight part of the path that the ray belongs to.
#pragma once

#include <utility>

#include "aureole/medium/medium.h"
#include "aureole/scene/interior_list.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/contact.h"

namespace aureole {

/// A ray, the medium around its origin and the bodies that contain the origin. In scenes without media only
/// the ray is kept up to date.
struct RayState {
  Ray ray;
  const Medium* medium = nullptr;  ///< medium at the origin of the ray, or null
  InteriorList interiors;          ///< bodies with a rank that the origin lies in
  /// Distance from the surface that the ray leaves to its origin, which lies off that surface by the bound of its
  /// rounding error: media count from the surface. Kept up to date in scenes with media.
  float offset = 0;

  /// The touching surfaces that the ray has hit, with the medium and bodies behind them; null elsewhere.
  const Contact* contact = nullptr;

  /// The ray with its origin moved back to the surface that it leaves.
  Ray from_surface() const { return {ray.o - ray.d * offset, ray.d, ray.t_max}; }

  /// Whether a surface that the ray hits is inactive: a body of higher rank fills the space around it, or one of the
  /// same index of refraction lies on its other side.
  bool is_inactive(const SurfacePoint& point, const Wavelengths& w) const {
    if (contact) return contact->is_inactive;
    return point.surface->rank != 0 && !interiors.empty() && is_inactive_body(point, w);
  }
  /// The bodies on the outside of a surface with a rank that the ray hits along `d`.
  const InteriorList& around(const SurfacePoint& point, const Vec3& d) const {
    return contact && dot(d, point.ng) > 0 ? contact->across : interiors;
  }
  bool is_inactive_body(const SurfacePoint& point, const Wavelengths& w) const;
  /// Updates medium and interiors at a surface, which the path has hit along `from` and leaves along `to`, on
  /// either side.
  void pass(const SurfacePoint& point, const Vec3& from, const Vec3& to) {
    const Surface& surface = *point.surface;
    const bool inwards = dot(to, point.ng) < 0, is_reflected = inwards != (dot(from, point.ng) < 0);
    if (const Contact* crossed = std::exchange(contact, nullptr)) {
      if (!is_reflected) interiors = crossed->across, medium = crossed->medium;
      return;
    }
    if (surface.rank == 0) {
      medium = surface.medium_along(to, point.ng, medium);
      return;
    }
    if (is_reflected) return;
    const InteriorList::Body body{&surface, point.instance}, before = interiors.filling();
    interiors.pass(body, inwards);
    medium = medium_across(before.surface || inwards ? before : body, interiors.filling(), medium);
  }
};

/// A straight part of a path from one vertex to the next, across null surfaces and inactive ones. The ray is
/// the piece of it that is still to be traced.
struct Segment : RayState {
  Vec3 origin;       ///< origin of the segment's first ray
  float behind = 0;  ///< distance along the segment that lies behind the present ray

  /// Begins at the present ray.
  void begin() { origin = ray.o, behind = 0; }
};

/// Sets medium and interiors around the origin of the ray, which belongs to the sensor or, given `light`,
/// leaves that light: an emitter or a sensor may state its medium.
void find_interiors(const Scene& scene, const Light* light, RayState& state);
/// Sets medium and interiors by the boundaries around the origin of the ray alone.
void find_interiors(const Scene& scene, RayState& state);

}  // namespace aureole
