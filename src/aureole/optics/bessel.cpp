// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/bessel.h"

#include <boost/math/special_functions/bessel.hpp>

namespace aureole::optics {
namespace {

using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

double bessel_j0(double x) { return boost::math::cyl_bessel_j(0, x, Policy()); }
double bessel_j1(double x) { return boost::math::cyl_bessel_j(1, x, Policy()); }
double bessel_i0(double x) { return boost::math::cyl_bessel_i(0, x, Policy()); }

}  // namespace aureole::optics
