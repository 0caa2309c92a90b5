// SPDX-License-Identifier: Apache-2.0
// Circles, ellipses and annuli about the origin, whose transforms are Bessel functions.
#pragma once

#include "aureole/optics/aperture/aperture_shape.h"

namespace aureole::optics {

/// An ellipse with semi-axes along x and y. Its transform is the unit circle's with scaled q.
class EllipseAperture final : public ApertureShape {
public:
  /// Makes an ellipse. Throws std::domain_error unless both semi-axes are positive and finite.
  EllipseAperture(double radius_x, double radius_y);

  double area() const override { return area_; }
  double bounding_radius() const override { return radius_x_ > radius_y_ ? radius_x_ : radius_y_; }
  std::complex<double> transform(double qx, double qy) const override;
  bool is_circular() const override { return radius_x_ == radius_y_; }

private:
  double radius_x_, radius_y_, area_;
};

/// A circle without the concentric circle of `inner_radius`, which may be 0.
class AnnulusAperture final : public ApertureShape {
public:
  /// Makes an annulus. Throws std::domain_error unless 0 <= inner_radius < radius, both finite.
  AnnulusAperture(double radius, double inner_radius);

  double area() const override { return area_; }
  double bounding_radius() const override { return radius_; }
  std::complex<double> transform(double qx, double qy) const override;
  bool is_circular() const override { return true; }

private:
  double radius_, inner_radius_, area_;
};

}  // namespace aureole::optics
