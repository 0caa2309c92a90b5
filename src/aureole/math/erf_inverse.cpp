// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/erf_inverse.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>

namespace aureole {

double sample_between(double low, double high, double u) {
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::erf_inv(std::clamp(low + u * (high - low), -1 + 1e-15, 1 - 1e-15), Policy());
}

}  // namespace aureole
