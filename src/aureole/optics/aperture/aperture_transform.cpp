// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/aperture_transform.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/bessel.h"

namespace aureole::optics {

double circle_transform(double u) {
  u = std::abs(u);
  if (u < 0.05) {
    // Power series of 2 J1(u)/u; the first neglected term is u^8/737280 < 1e-16.
    const double u2 = u * u;
    return 1 - u2 / 8 * (1 - u2 / 24 * (1 - u2 / 48));
  }
  return 2 * bessel_j1(u) / u;
}

double circle_aperture_transform(double q, double radius) {
  if (!(radius > 0 && std::isfinite(radius)))
    throw std::domain_error("radius of a circular aperture must be positive and finite, got " +
                            std::to_string(radius));
  return std::numbers::pi * radius * radius * circle_transform(q * radius);
}

}  // namespace aureole::optics
