// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/exponential_integral.h"

#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <numbers>

namespace aureole::optics {

double exponential_integral(double u) {
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::expint(1, u, Policy());
}

double entire_exponential_integral(double u) {
  if (u > 1) return std::numbers::egamma + std::log(u) + exponential_integral(u);
  double term = 1, sum = 0;
  for (int k = 1; k < 24; ++k) {
    term *= -u / k;
    sum -= term / k;
  }
  return sum;
}

}  // namespace aureole::optics
