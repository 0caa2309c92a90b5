// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/scatterer_layer.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

void check_size_ratio(double size_ratio) {
  if (!(size_ratio >= kMinSizeRatio && size_ratio <= 1))
    throw std::domain_error("shape radius over correlation radius must be in [1/64, 1], got " +
                            std::to_string(size_ratio));
}

double checked_radius(double radius, const char* name) {
  if (!(radius > 0 && std::isfinite(radius)))
    throw std::domain_error(std::string(name) + " must be positive and finite, got " +
                            std::to_string(radius));
  return radius;
}

}  // namespace

double radial_intensity(double u, double size_ratio, double area_fraction) {
  check_size_ratio(size_ratio);
  const double shape = circle_transform(size_ratio * u);
  return shape * shape * hard_disc_structure_factor(u, area_fraction);
}

double radial_intensity_integral(double size_ratio, double area_fraction) {
  check_size_ratio(size_ratio);
  // The integrand falls only as u^-2. Without interference its integral is known, 2/size_ratio^2. The change
  // by interference falls as u^-3.5: less than 1e-6 of the integral is beyond 400.
  const auto change = [=](double u) {
    const double shape = circle_transform(size_ratio * u);
    return shape * shape * (hard_disc_structure_factor(u, area_fraction) - 1) * u;
  };
  using Rule = boost::math::quadrature::gauss<double, 10>;
  double sum = 0;
  // The integration has fine steps, since S' has a sharp peak near u = 3 at high area fractions and
  // oscillates with period pi beyond.
  for (int i = 0; i < 128; ++i) sum += Rule::integrate(change, i / 8.0, (i + 1) / 8.0);
  for (int i = 16; i < 400; ++i) sum += Rule::integrate(change, double(i), double(i + 1));
  return 2 / (size_ratio * size_ratio) + sum;
}

ScattererLayer::ScattererLayer(double shape_radius, double correlation_radius, double area_fraction)
    : shape_radius_(checked_radius(shape_radius, "shape radius")),
      correlation_radius_(checked_radius(correlation_radius, "correlation radius")),
      area_fraction_(area_fraction) {
  const double ratio = shape_radius / correlation_radius;
  // Integral of J relative to its Poisson value, so that the normalisation of an empty layer is a limit
  // instead of 0/0.
  const double relative_total = 0.5 * ratio * ratio * radial_intensity_integral(ratio, area_fraction);
  shape_fraction_ = area_fraction * ratio * ratio;
  total_ = shape_fraction_ * relative_total;
  normalisation_ = (1 - shape_fraction_) / relative_total;
}

double ScattererLayer::intensity(double q) const {
  const double density = area_fraction_ / (kPi * correlation_radius_ * correlation_radius_);
  const double f = circle_aperture_transform(q, shape_radius_);
  return density * f * f * hard_disc_structure_factor(q * correlation_radius_, area_fraction_);
}

}  // namespace aureole::optics
