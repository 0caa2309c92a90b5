// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/diffusion_dipole.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {

namespace {

/// Returns the factor A of the boundary condition that the fluence vanishes at 2 A D above the surface.
double boundary_factor(double index) {
  if (!(index > 0)) throw std::domain_error("the index must be positive, got " + std::to_string(index));
  const double f = fresnel_diffuse_reflectance(1 / index);
  return (1 + f) / (1 - f);
}

}  // namespace

Dipole::Dipole(const DiffusionCoefficients& medium, double index)
    : source_(medium.transport_length),
      image_(medium.transport_length * (1 + 4 * boundary_factor(index) / 3)),
      effective_(medium.effective),
      albedo_(medium.reduced_albedo) {
  if (!(medium.transport > 0)) throw std::domain_error("a dipole needs a medium with an extinction");
}

double Dipole::profile(double distance) const {
  const auto part = [&](double z) {
    const double d = std::hypot(distance, z);
    return z * (effective_ + 1 / d) * std::exp(-effective_ * d) / (d * d);
  };
  return albedo_ / (4 * std::numbers::pi) * (part(source_) + part(image_));
}

double Dipole::total() const {
  return albedo_ / 2 * (std::exp(-effective_ * source_) + std::exp(-effective_ * image_));
}

double dipole_reflectance(double reduced_albedo, double index) {
  const double s = std::sqrt(3 * (1 - reduced_albedo));
  return reduced_albedo / 2 * (1 + std::exp(-4 * boundary_factor(index) * s / 3)) * std::exp(-s);
}

double dipole_albedo(double reflectance, double index) {
  if (!(reflectance >= 0 && reflectance <= 1))
    throw std::domain_error("reflectance must be in [0, 1], got " + std::to_string(reflectance));
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (dipole_reflectance(middle, index) < reflectance ? low : high) = middle;
  }
  return high;
}

}  // namespace aureole::optics
