// SPDX-License-Identifier: Apache-2.0
// Sampling of the part of a cylinder's front that is visible from a point.
#pragma once

#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A right circular cylinder around the z axis, z from 0 to `length`, as seen from a reference point.
/// Directions are spherical coordinates about its axis: the azimuth is sampled uniformly over the range that
/// hits the cylinder, the sine of the elevation over the range between its ends. The density is constant for
/// each azimuth, and nearly so over all of them.
class RoundView {
public:
  RoundView(const Double3& reference, double radius, double length, bool inward);

  bool empty() const { return !(half_range_ > 0); }
  /// Samples a point. Returns false if it is the reference point itself, which then lies on the surface.
  bool sample(Vec2 u, Double3& p) const;
  /// Returns the pdf of the direction to a point of the front [1/sr].
  double pdf(const Double3& p) const;

private:
  /// Computes the sines of the elevations of both ends, at a distance from the reference point perpendicular
  /// to the axis.
  void ends(double distance, double& lower, double& upper) const;

  Double3 o_;
  double radius_, length_;
  double from_axis_;       ///< distance of the reference point from the axis
  double half_range_ = 0;  ///< half the range of azimuths about the direction to the axis
  bool inward_;
};

/// The image of the cylinder x^2 + y^2 = 1, z in [0, 1] under any affine map: area sampling of its front in
/// local coordinates. The map preserves on which side of a tangent plane a point lies.
class AffineView {
public:
  /// Prepares sampling from `o`, the reference point in the cylinder's local coordinates.
  AffineView(const Double3& o, bool inward);

  bool empty() const { return !(half_range_ > 0); }
  Double3 sample(Vec2 u) const;
  /// Returns the density over azimuth and z.
  double pdf() const { return 1 / (2 * half_range_); }

private:
  double middle_ = 0, half_range_ = 0;  ///< range of azimuths that faces the point
};

}  // namespace aureole
