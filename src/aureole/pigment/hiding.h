// SPDX-License-Identifier: Apache-2.0
// Hiding power and tinting strength of paints.
#pragma once

#include <functional>

#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// Contrast ratio of a layer: its outer reflectance over black divided by its outer reflectance over white,
/// in (0, 1]. Opacity is this ratio in per cent. The substrates' reflectances are inner ones, 0 and 0.8 as in
/// TAPPI's opacity.
double contrast_ratio(Coefficients c, double thickness, const Surface& surface = {}, double black = 0,
                      double white = 0.8);

/// The contrast ratio at which a layer is visually opaque (ISO 6504).
inline constexpr double kHidden = 0.98;

/// The smallest thickness at which a contrast ratio, an increasing function of thickness, reaches `target` in
/// (0, 1). Infinite if it does not within 1e12. `start` is any thickness of the expected order of magnitude.
/// Relative error 1e-12.
double hiding_thickness(const std::function<double(double)>& contrast, double start, double target = kHidden);

/// Hiding thickness at a single wavelength.
double hiding_thickness(Coefficients c, const Surface& surface = {}, double target = kHidden,
                        double black = 0, double white = 0.8);

/// Area in m^2 that one litre of wet paint covers with a dry film of this thickness [m]: solids/thickness/1000. `solids`
/// is the volume of the dry film per volume of wet paint, in (0, 1].
double spreading_rate(double dry_thickness, double solids);
/// Thickness [m] of the dry film at a spreading rate [m^2/l].
double dry_thickness(double spreading_rate, double solids);

/// Tinting strength of a paint relative to a standard, from tints of both with equal fractions in the same
/// white. It is the ratio of the increases over the white's K/S, at the wavelength of strongest absorption or
/// summed over wavelengths.
double tinting_strength(double sample_k_over_s, double standard_k_over_s, double white_k_over_s);

}  // namespace aureole::pigment
