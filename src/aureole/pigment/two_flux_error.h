// SPDX-License-Identifier: Apache-2.0
// How far Kubelka and Munk's two fluxes are from radiative transfer, for one layer in diffuse light.
#pragma once

#include <optional>

#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {

struct ScatteringLayer {
  double albedo = 0.9;   ///< scattering over extinction, in [1e-6, 1]
  double thickness = 1;  ///< in transport lengths 1/(sigma_s (1 - g)), in [1e-6, 1e6]
  double g = 0;          ///< mean cosine of Henyey and Greenstein's phase function, in [-.99, .99]
  double index = 1.5;    ///< of the layer, in [1, 10]; 1 is no interface
  double substrate = 0;  ///< reflectance of the Lambertian surface it lies on, in [0, 1]
};

struct TwoFluxError {
  double reflectance = 0, lightness = 0;  ///< R by transport, and its CIE 1976 L*
  /// R and L* by Kubelka and Munk with Saunderson's interface, less these; none where S is negative by the
  /// convention.
  std::optional<double> error, lightness_error;
};

/// Transport is solved by 32 streams (optics/stack). Throws std::domain_error for arguments out of range.
TwoFluxError two_flux_error(const ScatteringLayer& layer, Convention convention = Convention::three_quarters);

}  // namespace aureole::pigment
