// SPDX-License-Identifier: Apache-2.0
// Light that an instrument of a small aperture misses, because it leaves the paint beside the area that is measured.
#pragma once

#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// Outer reflectance of a layer that an instrument measures which lights a disc of this radius and receives light from the
/// same disc; of a wide field it measures that of `reflectance_over` under the interface.
///
/// A pattern of light of the spatial frequency q spreads by diffusion as if the layer absorbed K + 2 D q^2 instead of K, with D =
/// 1/(3 (K/2 + 4/3 S)) for K = 2 sigma_a and S = 3/4 sigma_s (1 - g) (J. W. Goodman, Introduction to Fourier Optics, 1996, for
/// the spectrum of the disc, whose power up to x = q radius is 1 - J0(x)^2 - J1(x)^2). Diffusion holds where the disc is large
/// beside 1/S; light that spreads below the card and within the interface's multiple reflections is not followed.
/// `thickness` may be infinite; `substrate` is the inner reflectance of the card. Throws std::domain_error for arguments
/// out of range.
double disc_reflectance(const Coefficients& c, double thickness, double substrate, const Surface& surface,
                        double radius);

}  // namespace aureole::pigment
