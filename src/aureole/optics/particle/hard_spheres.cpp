// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/hard_spheres.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace aureole::optics {

double hard_sphere_structure_factor(double u, double f) {
  if (!(f >= 0 && f <= kMaxHardSphereFraction))
    throw std::domain_error("volume fraction of hard spheres must be in [0, 0.6], got " + std::to_string(f));
  const double denominator = std::pow(1 - f, 4);
  const double alpha = (1 + 2 * f) * (1 + 2 * f) / denominator;
  const double beta = -6 * f * (1 + f / 2) * (1 + f / 2) / denominator, gamma = 0.5 * f * alpha;
  // The integral over s in [0, 1] of s^2 (alpha + beta s + gamma s^3) sin(A s)/(A s) is -1/(24 f) times the
  // direct correlation function, with A = 2 u.
  const double a = 2 * std::abs(u), a2 = a * a;
  double integral = 0;
  if (a < 2) {
    double term = 1;
    for (int k = 0; k < 14; ++k) {
      integral += term * (alpha / (2 * k + 3) + beta / (2 * k + 4) + gamma / (2 * k + 6));
      term *= -a2 / ((2 * k + 2) * (2 * k + 3));
    }
  } else {
    const double s = std::sin(a), c = std::cos(a);
    integral = (alpha * (s - a * c) / a2 + beta * (2 * a * s + (2 - a2) * c - 2) / (a2 * a) +
                gamma * (-a2 * a2 * c + 4 * ((3 * a2 - 6) * c + (a2 - 6) * a * s + 6)) / (a2 * a2 * a)) /
               a;
  }
  return 1 / (1 + 24 * f * integral);
}

}  // namespace aureole::optics
