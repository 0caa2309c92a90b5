// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/single_scattering.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/particle/henyey_greenstein.h"

namespace aureole::optics {

SingleScattering::SingleScattering(double g, double index) {
  if (!(std::abs(g) < 1)) throw std::domain_error("asymmetry must be in (-1, 1), got " + std::to_string(g));
  if (!(index > 0)) throw std::domain_error("the index must be positive, got " + std::to_string(index));
  // The variable of integration is the sine of the angle outside: transmission ends where it is 1.
  using Rule = boost::math::quadrature::gauss<double, kNodes>;
  const double last = index > 1 ? std::asin(1 / index) : std::numbers::pi / 2;
  for (std::size_t i = 0; i < std::size_t(kNodes); ++i) {
    const std::size_t j = i / 2;
    const double a = (i % 2 ? 1 : -1) * Rule::abscissa()[j], t = (1 + a) / 2;
    // Near the last angle the transmission behaves as a square root: 1 - (1 - t)^2 smooths it.
    const double theta = last * t * (2 - t), c = std::cos(theta);
    const double step = Rule::weights()[j] / 2 * last * 2 * (1 - t);
    rates[i] = 1 / std::tan(theta / 2);
    weights[i] =
        2 * std::numbers::pi * step * henyey_greenstein(-c, g) * c * (1 - fresnel_reflectance(c, index, 1));
  }
}

double SingleScattering::profile(double x) const {
  double sum = 0;
  for (std::size_t i = 0; i < std::size_t(kNodes); ++i) sum += weights[i] * std::exp(-rates[i] * x);
  return sum / (2 * std::numbers::pi * x);
}

double SingleScattering::total() const {
  double sum = 0;
  for (std::size_t i = 0; i < std::size_t(kNodes); ++i) sum += weights[i] / rates[i];
  return sum;
}

}  // namespace aureole::optics
