// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/structure_factor.h"

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture_transform.h"

namespace aureole::optics {

double hard_disc_structure_factor(double u, double area_fraction) {
  if (!(area_fraction >= 0 && area_fraction <= kMaxAreaFraction))
    throw std::domain_error("area fraction of hard discs must be in [0, 0.7], got " +
                            std::to_string(area_fraction));
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  u = std::abs(u);
  const double ratio = area_fraction / (1 - area_fraction);
  const double disc = circle_transform(u);
  const double j0 = boost::math::cyl_bessel_j(0, u, Policy());
  // Pairs exclude a disc of radius 2a; the other two terms count the overlaps of edges and of areas.
  const double c = 4 * ratio * circle_transform(2 * u) + 4 * ratio * ratio * j0 * disc +
                   (ratio * ratio + 2 * ratio * ratio * ratio) * disc * disc;
  return 1 / (1 + c);
}

}  // namespace aureole::optics
