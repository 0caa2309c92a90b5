// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/hiding.h"

#include <cmath>
#include <limits>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {

double contrast_ratio(Coefficients c, double thickness, const Surface& surface, double black, double white) {
  require(white > black, white, "reflectance of the white substrate", "must exceed that of the black one");
  const LayerTransfer free = layer(c, thickness);
  return outer_reflectance(surface, reflectance_over(free, black)) /
         outer_reflectance(surface, reflectance_over(free, white));
}

double hiding_thickness(const std::function<double(double)>& contrast, double start, double target) {
  require(target > 0 && target < 1, target, "contrast ratio", "must be in (0, 1)");
  require(start > 0 && std::isfinite(start), start, "thickness", "must be positive and finite");
  constexpr double kMaxRatio = 1e12;
  double high = start;
  while (!(contrast(high) >= target))
    if ((high *= 2) > kMaxRatio * start) return std::numeric_limits<double>::infinity();
  double low = high;
  while (low > start / kMaxRatio && contrast(low) >= target) low /= 2;
  while (high - low > 1e-13 * high) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (contrast(middle) >= target ? high : low) = middle;
  }
  return high;
}

double hiding_thickness(Coefficients c, const Surface& surface, double target, double black, double white) {
  const double rate = c.k + c.s;
  if (!(rate > 0)) return std::numeric_limits<double>::infinity();
  return hiding_thickness([&](double x) { return contrast_ratio(c, x, surface, black, white); }, 1 / rate,
                          target);
}

double spreading_rate(double dry_thickness, double solids) {
  require(dry_thickness > 0, dry_thickness, "thickness", "must be positive");
  require(solids > 0 && solids <= 1, solids, "volume fraction of solids", "must be in (0, 1]");
  return 1e-3 * solids / dry_thickness;
}

double dry_thickness(double rate, double solids) {
  require(rate > 0, rate, "spreading rate", "must be positive");
  require(solids > 0 && solids <= 1, solids, "volume fraction of solids", "must be in (0, 1]");
  return 1e-3 * solids / rate;
}

double tinting_strength(double sample_k_over_s, double standard_k_over_s, double white_k_over_s) {
  const double standard = standard_k_over_s - white_k_over_s;
  require(standard > 0, standard, "what the standard adds to the white's K/S", "must be positive");
  return (sample_k_over_s - white_k_over_s) / standard;
}

}  // namespace aureole::pigment
