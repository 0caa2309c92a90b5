// SPDX-License-Identifier: Apache-2.0
// The error of Kubelka and Munk's two-flux theory against radiative transfer, for one layer in diffuse light.
#pragma once

#include <optional>

#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {

struct ScatteringLayer {
  double albedo = 0.9;   ///< single-scattering albedo, in [1e-6, 1]
  double thickness = 1;  ///< thickness in transport lengths 1/(sigma_s (1 - g)), in [1e-6, 1e6]
  double g = 0;          ///< mean cosine of the Henyey-Greenstein phase function, in [-0.99, 0.99]
  double index = 1.5;    ///< IOR of the layer, in [1, 10]; 1: no interface
  double substrate = 0;  ///< reflectance of the Lambertian substrate, in [0, 1]
};

struct TwoFluxError {
  double reflectance = 0, lightness = 0;  ///< R by radiative transfer, and its CIE 1976 L*
  /// R and L* by Kubelka and Munk with Saunderson's interface, minus the values above; nothing if the
  /// convention gives a negative S.
  std::optional<double> error, lightness_error;
};

/// Radiative transfer is solved with 32 streams (optics/stack). Throws std::domain_error for arguments out of
/// range.
TwoFluxError two_flux_error(const ScatteringLayer& layer, Convention convention = Convention::three_quarters);

}  // namespace aureole::pigment
