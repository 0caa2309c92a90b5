// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/transport_coefficients.h"

#include "aureole/pigment/domain.h"

namespace aureole::pigment {

std::string_view name_of(Convention convention) {
  switch (convention) {
    case Convention::three_quarters:
      return "three_quarters";
    case Convention::diffusion:
      return "diffusion";
    case Convention::double_gauss:
      return "double_gauss";
  }
  throw std::logic_error("no such convention");
}

std::vector<Convention> conventions() {
  return {Convention::three_quarters, Convention::diffusion, Convention::double_gauss};
}

std::vector<std::string> convention_names() {
  std::vector<std::string> names;
  for (const Convention c : conventions()) names.emplace_back(name_of(c));
  return names;
}

Convention convention_named(std::string_view name) {
  for (const Convention c : conventions())
    if (name_of(c) == name) return c;
  throw std::domain_error("no convention is called \"" + std::string(name) + "\"");
}

Coefficients coefficients_of_transport(double sigma_a, double sigma_s, double g, Convention convention) {
  require_not_negative(sigma_a, "sigma_a");
  require_not_negative(sigma_s, "sigma_s");
  require(g >= -1 && g <= 1, g, "g", "must be in [-1, 1]");
  const double k = 2 * sigma_a;
  switch (convention) {
    case Convention::three_quarters:
      return {k, 0.75 * sigma_s * (1 - g)};
    case Convention::diffusion:
      return {k, 0.75 * sigma_s * (1 - g) - 0.25 * sigma_a};
    case Convention::double_gauss:
      return {k, sigma_s * (1 - 0.75 * g)};
  }
  throw std::logic_error("no such convention");
}

TransportCoefficients transport_of_coefficients(Coefficients c, double g, Convention convention) {
  require_not_negative(c.k, "K");
  require_not_negative(c.s, "S");
  require(g >= -1 && g <= 1, g, "g", "must be in [-1, 1]");
  const double sigma_a = 0.5 * c.k;
  if (convention == Convention::double_gauss) return {sigma_a, c.s / (1 - 0.75 * g)};
  require(g < 1, g, "g", "must be below 1");
  const double reduced = convention == Convention::diffusion ? c.s + 0.25 * sigma_a : c.s;
  return {sigma_a, reduced / (0.75 * (1 - g))};
}

}  // namespace aureole::pigment
