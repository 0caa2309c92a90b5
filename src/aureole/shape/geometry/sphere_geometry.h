// SPDX-License-Identifier: Apache-2.0
// A ball: ray casting as an Embree user geometry, and sampling of the part of it that a point sees.
#pragma once

#include <embree3/rtcore.h>

#include <optional>

#include "aureole/shape/geometry/double3.h"

namespace aureole {

struct Ball {
  Double3 center;
  double radius = 1;
  bool inward = false;  ///< the front is the inside: sampling is from points inside

  Bounds3 bounds() const;  ///< rounded outwards
  /// The nearest distance in (t_min, t_max) at which the ray meets the surface, from outside or inside.
  std::optional<double> intersect(const Double3& o, const Double3& d, double t_min, double t_max) const;

  /// True where the point sees the ball from outside. Sampling and density both ask this, so that near the
  /// surface they agree. For an inward ball a point on the surface, to within rounding, counts as inside: it
  /// sees the far side.
  bool sees_from_outside(const Double3& reference) const;
  /// True where a point of the ball at this distance may be the reference point itself, up to rounding;
  /// sampling from inside leaves it out.
  bool is_self(const Double3& reference, double distance) const;
  /// The unit vector from the centre to a visible point: from outside uniform over the cone of directions
  /// that meet the ball, from inside over all directions; nothing where a direction meets nothing (only from
  /// points on the surface).
  std::optional<Double3> sample_visible(const Double3& reference, Vec2 u) const;
  /// Density of sample_visible [1/sr]; it is the same for all visible points.
  float visible_pdf(const Double3& reference) const;
};

/// A committed Embree geometry; `ball` must outlive it.
RTCGeometry make_sphere_geometry(RTCDevice device, const Ball& ball);

}  // namespace aureole
