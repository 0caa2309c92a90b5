// SPDX-License-Identifier: Apache-2.0
// K and S from the coefficients of radiative transfer, sigma_a, sigma_s and the mean cosine g. There is no
// exact relation, because two fluxes do not determine the angular distribution of light. For isotropic light
// K = 2 sigma_a, since the mean path through a thin slab is twice its thickness. For S there are several
// conventions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// A convention for S. For comparison: R_inf of a half-space of isotropic scatterers, index 1, diffuse light,
/// is 0.1465, 0.478 and 0.795 for albedos of 0.5, 0.9 and 0.99 by radiative transfer. Each convention's own
/// values are given.
enum class Convention {
  /// 3/4 sigma_s (1 - g): 0.139, 0.471, 0.793
  three_quarters,
  /// 3/4 sigma_s (1 - g) - sigma_a/4, matched to diffusion; negative for strong absorbers: 0.101, 0.465,
  /// 0.793
  diffusion,
  /// sigma_s (1 - 3/4 g), two-stream discrete ordinates at cosines +-1/2: 0.172, 0.520, 0.818
  double_gauss
};

/// Returns "three_quarters", "diffusion" or "double_gauss".
std::string_view name_of(Convention convention);
/// All conventions, in the order of their declaration, and their names.
std::vector<Convention> conventions();
std::vector<std::string> convention_names();
/// Returns the convention of that name; throws std::domain_error for an unknown name.
Convention convention_named(std::string_view name);

/// K = 2 sigma_a, and S by the convention. sigma_a and sigma_s are >= 0 per length, g is in [-1, 1].
Coefficients coefficients_of_transport(double sigma_a, double sigma_s, double g,
                                       Convention convention = Convention::three_quarters);

/// Absorption and scattering coefficients per length.
struct TransportCoefficients {
  double sigma_a = 0, sigma_s = 0;
};

/// Returns absorption and scattering of a medium with mean cosine g that has this K and S by the convention.
/// Throws std::domain_error for g = 1 with a convention proportional to 1 - g, where S does not determine
/// sigma_s.
TransportCoefficients transport_of_coefficients(Coefficients c, double g,
                                                Convention convention = Convention::three_quarters);

}  // namespace aureole::pigment
