// SPDX-License-Identifier: Apache-2.0
// Sampling of a circular disc by the solid angle that it fills.
#pragma once

#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A disc as seen from a point in front of it. The directions that meet the disc form an elliptic cone, whose
/// axis and half-angles have a closed form (Guillén et al. 2017, "Area-preserving parameterizations for
/// spherical ellipses", section 3). The azimuth about that axis is drawn as if the ellipse, projected equally
/// in area (Lambert), were plane; the polar angle uniformly in solid angle up to the rim. The density is
/// constant for circular cones and varies by less than a third for others; no direction misses the disc.
class DiscView {
public:
  enum class Technique { none, area, solid_angle };

  /// `n`: the unit normal of the front.
  static DiscView of(const Double3& reference, const Double3& center, const Double3& n, double radius);
  /// Area sampling wherever the front is seen.
  static DiscView by_area(const Double3& reference, const Double3& center, const Double3& n);

  Technique technique() const { return technique_; }
  /// A point of the disc (solid_angle only).
  Double3 sample(Vec2 u) const;
  /// Density for a direction of any length that leads to the disc [1/sr] (solid_angle only).
  double pdf(const Double3& d) const;

private:
  /// 1 - cos of the polar angle of the rim, and the density there, for an azimuth.
  struct Rim {
    double one_minus_cos, pdf;
  };
  Rim rim(double cos_phi, double sin_phi) const;

  Technique technique_ = Technique::none;
  Double3 reference_, normal_;
  double height_ = 0;               ///< of the reference point above the plane
  Double3 x_, y_, z_;               ///< principal axes of the cone
  double cot2_x_ = 0, cot2_y_ = 0;  ///< squared cotangents of its half-angles
  double a_ = 0, b_ = 0;            ///< half-axes in Lambert's projection
};

}  // namespace aureole
