// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/kubelka_munk_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check(Coefficients c) {
  require(c.k >= 0 && std::isfinite(c.k), c.k, "K", "must be finite and not negative");
  require(c.s >= 0 && std::isfinite(c.s), c.s, "S", "must be finite and not negative");
}

}  // namespace

double Coefficients::ratio() const { return s > 0 ? k / s : k > 0 ? kInfinity : 0; }

LayerTransfer layer(Coefficients c, double thickness) {
  check(c);
  require_not_negative(thickness, "thickness");
  // gamma = b S = sqrt(K (K + 2 S)) is the attenuation of both fluxes far from the boundaries. With e =
  // exp(-gamma X), the textbook's hyperbolic functions divided by exp(gamma X) are bounded, and q = (1 -
  // e^2)/gamma stays finite for gamma -> 0.
  const double gamma = std::sqrt(c.k * (c.k + 2 * c.s));
  if (gamma == 0) {
    if (c.s == 0) return {0, 1};
    if (std::isinf(thickness)) return {1, 0};
    return {c.s * thickness / (1 + c.s * thickness), 1 / (1 + c.s * thickness)};
  }
  const double lost = -std::expm1(-2 * gamma * thickness);  // 1 - e^2
  const double q = lost / gamma, denominator = (c.k + c.s) * q + 2 - lost;
  return {c.s * q / denominator, 2 * std::exp(-gamma * thickness) / denominator};
}

double reflectance_over(LayerTransfer layer, double substrate) {
  require_fraction(substrate, "reflectance of the substrate");
  if (layer.transmittance == 0) return layer.reflectance;
  const double sum = layer.reflectance + layer.transmittance * layer.transmittance * substrate /
                                             (1 - layer.reflectance * substrate);
  return std::min(sum, 1.0);  // rounding errors over a white substrate may exceed 1
}

LayerTransfer stacked(LayerTransfer upper, LayerTransfer lower) {
  return {reflectance_over(upper, lower.reflectance),
          upper.transmittance == 0
              ? 0
              : upper.transmittance * lower.transmittance / (1 - upper.reflectance * lower.reflectance)};
}

Fluxes fluxes_within(Coefficients c, double thickness, double substrate, double depth) {
  require(depth >= 0 && depth <= thickness, depth, "depth", "must lie in the layer");
  const LayerTransfer above = layer(c, depth);
  const double below = reflectance_over(layer(c, thickness - depth), substrate);
  const double down = above.transmittance == 0 ? 0 : above.transmittance / (1 - above.reflectance * below);
  return {down, below * down};
}

double opaque_reflectance(double k_over_s) {
  require_not_negative(k_over_s, "K/S");
  return 1 / (1 + k_over_s + std::sqrt(k_over_s * (k_over_s + 2)));
}

double k_over_s(double opaque_reflectance) {
  require(opaque_reflectance > 0 && opaque_reflectance <= 1, opaque_reflectance,
          "reflectance of an opaque layer", "must be in (0, 1]");
  const double absorbed = 1 - opaque_reflectance;
  return absorbed * absorbed / (2 * opaque_reflectance);
}

}  // namespace aureole::pigment
