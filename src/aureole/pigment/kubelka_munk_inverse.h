// SPDX-License-Identifier: Apache-2.0
// K and S from measured reflectances. Reflectances are inner ones, within the binder: the effect of the
// interface must be removed first (saunderson.h). All functions throw std::domain_error, with the reason, for
// reflectances that are impossible in this theory.
#pragma once

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// K and S from reflectance and transmittance of a free layer (Kubelka 1948, (31) and (32), rewritten so that
/// precision is lost for K -> 0 and S -> 0 only through 1 - R - T). The thickness is positive and finite, T >
/// 0.
Coefficients coefficients_of_transfer(LayerTransfer transfer, double thickness);

/// Reflectance of a layer over a substrate of known reflectance.
struct Drawdown {
  double reflectance = 0, substrate = 0;
};

/// Reflectance and transmittance of a layer from drawdowns over two substrates; the substrate of `light`
/// reflects more than the substrate of `dark`. Throws if the layer hides both, because its transmittance is then
/// undetermined.
LayerTransfer transfer_of_drawdowns(Drawdown dark, Drawdown light);

/// Applies `transfer_of_drawdowns` and then `coefficients_of_transfer`.
Coefficients coefficients_of_drawdowns(Drawdown dark, Drawdown light, double thickness);

/// K and S from the reflectance of an opaque layer, in (0, 1), and one drawdown of known thickness,
/// preferably over black.
Coefficients coefficients_of_opaque(double opaque_reflectance, Drawdown drawdown, double thickness);

/// The measurement of one tint: K/S of an opaque mixture of a fraction `share` of the paint with white.
struct Tint {
  double share = 0;     ///< fraction of the paint, in (0, 1)
  double k_over_s = 0;  ///< K/S of the mixture
};

/// S of a paint from K/S of its opaque masstone and a tint with a white of known coefficients. With the
/// white's S set to 1, the result is relative to the white's S. Not finite if masstone and tint have equal
/// K/S. Negative if the tint's K/S is not between white's and masstone's. Such data contradict the theory,
/// and the caller must count them.
double scattering_of_tint(double masstone_k_over_s, Tint tint, Coefficients white);

}  // namespace aureole::pigment
