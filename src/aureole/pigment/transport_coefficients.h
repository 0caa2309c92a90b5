// SPDX-License-Identifier: Apache-2.0
// K and S from the coefficients of radiative transport, sigma_a, sigma_s and the mean cosine g. There is no
// exact relation: two fluxes do not say how the light is spread over directions. For light that is the same
// in all directions K = 2 sigma_a, since the mean path through a thin slab is twice its thickness; for S
// there are several conventions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// The name of a relation for S. R_inf of a half-space of isotropic scatterers, index 1, diffuse light, is
/// .1465, .478 and .795 for albedos of .5, .9 and .99 by transport; each convention's own values are given.
enum class Convention {
  /// 3/4 sigma_s (1 - g): .139, .471, .793
  three_quarters,
  /// 3/4 sigma_s (1 - g) - sigma_a/4, matched to diffusion; negative for strong absorbers: .101, .465, .793
  diffusion,
  /// sigma_s (1 - 3/4 g), discrete ordinates of two streams at cosines +-1/2: .172, .520, .818
  double_gauss
};

/// "three_quarters", "diffusion", "double_gauss".
std::string_view name_of(Convention convention);
/// All conventions, in the order of their declaration, and their names.
std::vector<Convention> conventions();
std::vector<std::string> convention_names();
/// Throws std::domain_error for another name.
Convention convention_named(std::string_view name);

/// K = 2 sigma_a, and S by the convention; sigma_a and sigma_s are >= 0 per length, g in [-1, 1].
Coefficients coefficients_of_transport(double sigma_a, double sigma_s, double g,
                                       Convention convention = Convention::three_quarters);

/// Per length.
struct TransportCoefficients {
  double sigma_a = 0, sigma_s = 0;
};

/// The inverse: what a medium of this mean cosine absorbs and scatters whose K and S these are by the
/// convention. Throws std::domain_error for a g of 1 (and 3/4 sigma_s (1 - g)), which no S tells from nothing.
TransportCoefficients transport_of_coefficients(Coefficients c, double g,
                                                Convention convention = Convention::three_quarters);

}  // namespace aureole::pigment
