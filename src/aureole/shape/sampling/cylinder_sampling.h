// SPDX-License-Identifier: Apache-2.0
// Sampling of the part of a cylinder's front that a point sees.
#pragma once

#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A right circular cylinder around the z axis, z from 0 to `length`, as seen from a point. Directions are
/// those of spherical coordinates about its axis: the azimuth is drawn uniformly over the range that meets
/// the cylinder, the sine of the elevation over the range that lies between its ends. The density is constant
/// for each azimuth, and nearly so over all of them.
class RoundView {
public:
  RoundView(const Double3& reference, double radius, double length, bool inward);

  bool empty() const { return !(half_range_ > 0); }
  /// A point; nothing where it is the reference point itself, which lies on the surface.
  bool sample(Vec2 u, Double3& p) const;
  /// Density of the direction that leads to a point of the front [1/sr].
  double pdf(const Double3& p) const;

private:
  /// The sines of the elevations of the two ends at a distance from the reference point across the axis.
  void ends(double distance, double& lower, double& upper) const;

  Double3 o_;
  double radius_, length_;
  double from_axis_;       ///< distance of the reference point
  double half_range_ = 0;  ///< of azimuths about the direction to the axis
  bool inward_;
};

/// The image of the cylinder x^2 + y^2 = 1, z in [0, 1] under any affine map: area sampling of the front, in
/// its own coordinates. Which side of a tangent plane a point lies on does not change under the map.
class AffineView {
public:
  /// `o`: the reference point in the cylinder's coordinates.
  AffineView(const Double3& o, bool inward);

  bool empty() const { return !(half_range_ > 0); }
  Double3 sample(Vec2 u) const;
  /// Density of azimuth and z.
  double pdf() const { return 1 / (2 * half_range_); }

private:
  double middle_ = 0, half_range_ = 0;  ///< azimuths of the part that faces the point
};

}  // namespace aureole
