// SPDX-License-Identifier: Apache-2.0
// Sampling of a circular disc by its solid angle.
#pragma once

#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A disc as seen from a point in front of it. Directions that hit the disc form an elliptic cone, whose axis
/// and half-angles have a closed form (Guillén et al. 2017, "Area-preserving parameterizations for spherical
/// ellipses", section 3). The azimuth about that axis is sampled as for a plane ellipse: the cone's
/// equal-area projection (Lambert). The polar angle is sampled uniformly in solid angle up to the rim. The
/// density is constant for circular cones and varies by less than a third for others; every direction hits
/// the disc.
class DiscView {
public:
  enum class Technique { none, area, solid_angle };

  /// Makes a view of a disc; `n` is the unit normal of the front.
  static DiscView of(const Double3& reference, const Double3& center, const Double3& n, double radius);
  /// Makes a view that uses area sampling wherever the front is visible.
  static DiscView by_area(const Double3& reference, const Double3& center, const Double3& n);

  Technique technique() const { return technique_; }
  /// Samples a point on the disc (solid_angle only).
  Double3 sample(Vec2 u) const;
  /// Returns the pdf [1/sr] of a direction of any length that hits the disc (solid_angle only).
  double pdf(const Double3& d) const;

private:
  /// 1 - cos of the rim's polar angle at an azimuth, and the density there.
  struct Rim {
    double one_minus_cos, pdf;
  };
  Rim rim(double cos_phi, double sin_phi) const;

  Technique technique_ = Technique::none;
  Double3 reference_, normal_;
  double height_ = 0;               ///< height of the reference point above the plane
  Double3 x_, y_, z_;               ///< principal axes of the cone
  double cot2_x_ = 0, cot2_y_ = 0;  ///< squared cotangents of the cone's half-angles
  double a_ = 0, b_ = 0;            ///< half-axes in Lambert's projection
};

}  // namespace aureole
