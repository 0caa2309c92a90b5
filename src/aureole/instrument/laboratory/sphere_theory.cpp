// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/sphere_theory.h"

#include <cmath>

namespace aureole {

double port_fraction(double port_radius, double sphere_radius) {
  const double s = port_radius / sphere_radius;
  // (1 - sqrt(1 - s^2))/2 without cancellation.
  return 0.5 * s * s / (1 + std::sqrt(1 - s * s));
}

}  // namespace aureole
