// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/kubelka_munk_inverse.h"

#include <algorithm>
#include <cmath>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

void check_thickness(double thickness) {
  require(thickness > 0 && std::isfinite(thickness), thickness, "thickness", "must be positive and finite");
}

}  // namespace

Coefficients coefficients_of_transfer(LayerTransfer transfer, double thickness) {
  check_thickness(thickness);
  const double r = transfer.reflectance, t = transfer.transmittance, absorbed = 1 - r - t;
  require_fraction(r, "reflectance");
  require(t > 0 && t <= 1, t, "transmittance", "must be in (0, 1]");
  require(absorbed >= -1e-14, r + t, "reflectance plus transmittance", "must not exceed 1");
  if (r == 0) return {-std::log(t) / thickness, 0};
  // R_inf + 1/R_inf = p/R with p = 1 + R^2 - T^2. Differences are expressed by the absorbed fraction and its
  // square root, which both vanish for K -> 0, so that their quotients have a limit:
  // p^2 - 4 R^2 = absorbed g^2, p - 2 R = absorbed (1 - R + T). gamma = sqrt(K (K + 2 S)), X is the thickness.
  const double root = std::sqrt(std::max(absorbed, 0.0)), rest = 1 - r + t;
  const double g = std::sqrt((1 + r - t) * (1 + r + t) * rest);
  const double p = (1 - t) * (1 + t) + r * r, sum = p + root * g;
  const double absorbed_deep = root * (root * rest + g) / sum;  // 1 - R_inf
  const double per_deep = root * sum / (root * rest + g);       // absorbed/(1 - R_inf)
  const double reflected_deep = 2 * r / sum;                    // R_inf
  const double inner = (1 - r) + absorbed_deep * r;             // 1 - R_inf R
  const double lost = (absorbed + absorbed_deep * r) / inner;   // 1 - exp(-gamma X)
  const double path = -std::log1p(-lost);                       // gamma X
  const double path_per_deep = lost > 0 ? (path / lost) * (per_deep + r) / inner : r / (1 - r);
  return {path * absorbed_deep / ((1 + reflected_deep) * thickness),
          path_per_deep * 2 * reflected_deep / ((1 + reflected_deep) * thickness)};
}

LayerTransfer transfer_of_drawdowns(Drawdown dark, Drawdown light) {
  for (const Drawdown& d : {dark, light}) {
    require_fraction(d.reflectance, "reflectance");
    require_fraction(d.substrate, "reflectance of the substrate");
  }
  require(light.substrate > dark.substrate, light.substrate, "reflectance of the light substrate",
          "must exceed that of the dark one");
  require(
      light.reflectance > dark.reflectance, light.reflectance, "reflectance over the light substrate",
      "must exceed that over the dark one (a layer that hides both needs the opaque reflectance instead)");
  // R = R0 + T^2 g/(1 - R0 g) holds for both drawdowns. The difference of both equations, times g2 and g1, is
  // a linear equation for R0.
  const double r = (light.substrate * dark.reflectance - dark.substrate * light.reflectance) /
                   (light.substrate - dark.substrate +
                    light.substrate * dark.substrate * (dark.reflectance - light.reflectance));
  const double t2 = (light.reflectance - r) * (1 - r * light.substrate) / light.substrate;
  if (!(r >= -1e-12 && t2 > 0))  // a layer that does not scatter has r = 0 except for rounding
    throw std::domain_error("no layer has reflectance " + number_text(dark.reflectance) + " over " +
                            number_text(dark.substrate) + " and " + number_text(light.reflectance) +
                            " over " + number_text(light.substrate));
  return {std::max(r, 0.0), std::sqrt(t2)};
}

Coefficients coefficients_of_drawdowns(Drawdown dark, Drawdown light, double thickness) {
  return coefficients_of_transfer(transfer_of_drawdowns(dark, light), thickness);
}

Coefficients coefficients_of_opaque(double opaque_reflectance, Drawdown drawdown, double thickness) {
  check_thickness(thickness);
  const double deep = opaque_reflectance;
  require(deep > 0 && deep < 1, deep, "reflectance of the opaque layer", "must be in (0, 1)");
  require_fraction(drawdown.reflectance, "reflectance");
  require_fraction(drawdown.substrate, "reflectance of the substrate");
  // (R - R_inf)/(1 - R_inf R) decays as exp(-2 gamma x) towards the surface.
  const double at_surface = (drawdown.reflectance - deep) * (1 - deep * drawdown.substrate);
  const double at_substrate = (drawdown.substrate - deep) * (1 - deep * drawdown.reflectance);
  const double decay = at_surface / at_substrate;
  if (!(decay > 0 && decay < 1))
    throw std::domain_error("the reflectance of a layer, " + number_text(drawdown.reflectance) +
                            ", must lie between that of its substrate, " + number_text(drawdown.substrate) +
                            ", and that of an opaque layer, " + number_text(deep));
  const double gamma = -0.5 * std::log(decay) / thickness;
  return {gamma * (1 - deep) / (1 + deep), gamma * 2 * deep / ((1 - deep) * (1 + deep))};
}

double scattering_of_tint(double masstone_k_over_s, Tint tint, Coefficients white) {
  require(tint.share > 0 && tint.share < 1, tint.share, "share of a paint in a tint", "must be in (0, 1)");
  return (1 - tint.share) * (tint.k_over_s * white.s - white.k) /
         (tint.share * (masstone_k_over_s - tint.k_over_s));
}

}  // namespace aureole::pigment
