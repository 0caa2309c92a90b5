// SPDX-License-Identifier: Apache-2.0
// rho (g(r) - 1) is the transform of S - 1 = -C/(1 + C), with rho the number density, S the structure factor,
// -C the transform of rho times the direct correlation function (Rosenfeld 1990), C = D + E, A(u) = 2 J1(u)/u
// and w = F/(1 - F) for the area fraction F.
// D = 4 w A(2u) belongs to the step of g at contact; E = 4 w^2 J0(u) A(u) + (w^2 + 2 w^3) A(u)^2 is smaller.
// In S - 1 = -D - E + D^2 + (2 D E + E^2 - C^3/(1 + C)) the first three terms have transforms in closed form
// (overlaps of discs and circles). The rest falls as u^-3.5, so its quadrature converges.
#include "aureole/optics/arrangement/hard_disc_pair_correlation.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/bessel.h"
#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Returns the common area of two discs of radius 1 at a distance r.
double overlap(double r) { return r < 2 ? 2 * std::acos(r / 2) - r / 2 * std::sqrt((2 - r) * (2 + r)) : 0; }

}  // namespace

double hard_disc_pair_correlation(double r, double area_fraction) {
  if (!(area_fraction >= 0 && area_fraction <= kMaxAreaFraction + kFractionTolerance))
    throw std::domain_error("area fraction of hard discs must be in [0, 0.7], got " +
                            std::to_string(area_fraction));
  if (!(r >= 0 && r <= 200))
    throw std::domain_error("distances of hard discs must be in [0, 200] radii, got " + std::to_string(r));
  // At contact, r = 2, the result is the limit from outside.
  if (area_fraction == 0) return r < 2 ? 0 : 1;
  const double w = area_fraction / (1 - area_fraction);
  const auto rest = [&](double u) {
    const double disc = circle_transform(u);
    const double d = 4 * w * circle_transform(2 * u);
    const double e = 4 * w * w * bessel_j0(u) * disc + (w * w + 2 * w * w * w) * disc * disc;
    const double c = d + e;
    return (2 * d + e) * e - c * c * c / (1 + c);
  };
  constexpr double kEnd = 300;
  const double panel = 4 * kPi / (r + 6);
  const int panels = int(std::ceil(kEnd / panel));
  double sum = 0;
  for (int i = 0; i < panels; ++i)
    sum += boost::math::quadrature::gauss<double, 20>::integrate(
        [&](double u) { return rest(u) * bessel_j0(u * r) * u; }, i * panel, (i + 1) * panel);
  double total = sum / (2 * kPi);
  total += 16 * w * w * 4 * overlap(r / 2) / (16 * kPi * kPi);
  if (r < 2)
    total -= w / kPi + 4 * w * w * std::acos(r / 2) / (kPi * kPi) +
             (w * w + 2 * w * w * w) * overlap(r) / (kPi * kPi);
  return 1 + total * kPi / area_fraction;
}

}  // namespace aureole::optics
