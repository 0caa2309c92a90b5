// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/erf_inverse.h"

#include <boost/math/special_functions/erf.hpp>

namespace aureole {

double erf_inverse(double x) {
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::erf_inv(x, Policy());
}

}  // namespace aureole
