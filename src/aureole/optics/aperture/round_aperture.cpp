// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/round_aperture.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"

namespace aureole::optics {

EllipseAperture::EllipseAperture(double radius_x, double radius_y)
    : radius_x_(radius_x), radius_y_(radius_y), area_(std::numbers::pi * radius_x * radius_y) {
  if (!(radius_x > 0 && radius_y > 0 && std::isfinite(radius_x) && std::isfinite(radius_y)))
    throw std::domain_error("the radii of an ellipse must be positive and finite, got " +
                            std::to_string(radius_x) + " and " + std::to_string(radius_y));
}

std::complex<double> EllipseAperture::transform(double qx, double qy) const {
  return area_ * circle_transform(std::hypot(qx * radius_x_, qy * radius_y_));
}

AnnulusAperture::AnnulusAperture(double radius, double inner_radius)
    : radius_(radius),
      inner_radius_(inner_radius),
      area_(std::numbers::pi * (radius - inner_radius) * (radius + inner_radius)) {
  if (!(inner_radius >= 0 && radius > inner_radius && std::isfinite(radius)))
    throw std::domain_error("the radii of an annulus must be finite with 0 <= inner < outer, got " +
                            std::to_string(inner_radius) + " and " + std::to_string(radius));
}

std::complex<double> AnnulusAperture::transform(double qx, double qy) const {
  const double q = std::hypot(qx, qy);
  return std::numbers::pi * (radius_ * radius_ * circle_transform(q * radius_) -
                             inner_radius_ * inner_radius_ * circle_transform(q * inner_radius_));
}

}  // namespace aureole::optics
