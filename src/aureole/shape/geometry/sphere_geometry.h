// SPDX-License-Identifier: Apache-2.0
// A sphere as an Embree user geometry, and sampling of the part visible from a point.
#pragma once

#include <embree3/rtcore.h>

#include <optional>

#include "aureole/shape/geometry/double3.h"

namespace aureole {

struct Ball {
  Double3 center;
  double radius = 1;
  bool inward = false;  ///< whether the front is the inside, so that points are sampled from inside

  Bounds3 bounds() const;  ///< bounds of the sphere, rounded outward
  /// Returns the nearest distance in (t_min, t_max) at which the ray intersects the surface, from outside or
  /// inside.
  std::optional<double> intersect(const Double3& o, const Double3& d, double t_min, double t_max) const;

  /// Whether the point sees the sphere from outside. Sampling and pdf both use this test, so that they agree
  /// near the surface. For an inward sphere a point on the surface, to within rounding, counts as inside: it
  /// sees the far side.
  bool sees_from_outside(const Double3& reference) const;
  /// Whether a point of the sphere at this distance may be the reference point itself, up to rounding.
  /// Sampling from inside leaves it out.
  bool is_self(const Double3& reference, double distance) const;
  /// Samples a visible point; returns the unit vector from the centre to it. From outside it is uniform over
  /// the cone of directions that hit the sphere, from inside over all directions. Empty if a direction hits
  /// nothing, which happens only from points on the surface.
  std::optional<Double3> sample_visible(const Double3& reference, Vec2 u) const;
  /// Returns the pdf of sample_visible [1/sr], which is constant over all visible points.
  float visible_pdf(const Double3& reference) const;
};

/// Returns a committed Embree geometry; `ball` must outlive it.
RTCGeometry make_sphere_geometry(RTCDevice device, const Ball& ball);

}  // namespace aureole
