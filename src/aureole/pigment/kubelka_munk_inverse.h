// SPDX-License-Identifier: Apache-2.0
// K and S from measured reflectances. Reflectances are those within the binder: take off the interface first
// (saunderson.h). All functions throw std::domain_error, which says what is impossible, for reflectances that
// no layer of this theory has.
#pragma once

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// From reflectance and transmittance of a layer alone (Kubelka 1948, (31) and (32), rewritten so that K -> 0
/// and S -> 0 lose no digits but those of 1 - R - T). The thickness is positive and finite, T > 0.
Coefficients coefficients_of_transfer(LayerTransfer transfer, double thickness);

/// Reflectance of a layer over a substrate of known reflectance.
struct Drawdown {
  double reflectance = 0, substrate = 0;
};

/// Reflectance and transmittance of a layer from drawdowns over two substrates, `light` reflecting more than
/// `dark`. Throws where the layer hides both, so that its transmittance cannot be told.
LayerTransfer transfer_of_drawdowns(Drawdown dark, Drawdown light);

/// The same, and then `coefficients_of_transfer`.
Coefficients coefficients_of_drawdowns(Drawdown dark, Drawdown light, double thickness);

/// From the reflectance of an opaque layer, in (0, 1), and one drawdown, best over black, of known thickness.
Coefficients coefficients_of_opaque(double opaque_reflectance, Drawdown drawdown, double thickness);

/// One tint: K/S of an opaque mixture in which the paint has this share, and white paint the rest.
struct Tint {
  double share = 0;     ///< in (0, 1)
  double k_over_s = 0;  ///< of the mixture
};

/// S of a paint from K/S of its opaque masstone and a tint with white whose coefficients are known (its S may
/// be taken as 1: then the result is relative to it). Not finite where masstone and tint have the same K/S,
/// negative where the tint's is not between those of white and masstone: such data do not fit the theory, and
/// it is for the caller to count them.
double scattering_of_tint(double masstone_k_over_s, Tint tint, Coefficients white);

}  // namespace aureole::pigment
