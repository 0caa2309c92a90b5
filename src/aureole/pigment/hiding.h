// SPDX-License-Identifier: Apache-2.0
// How well a paint hides what is below it, and how strongly it colours.
#pragma once

#include <functional>

#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// Contrast ratio of a layer: its outer reflectance over black divided by that over white, in (0, 1]. Opacity
/// is this ratio in per cent. The substrates' reflectances are inner ones, 0 and .8 as in TAPPI's opacity.
double contrast_ratio(Coefficients c, double thickness, const Surface& surface = {}, double black = 0,
                      double white = 0.8);

/// The ratio at which the eye takes a layer for opaque (ISO 6504).
inline constexpr double kHidden = 0.98;

/// The least thickness at which a contrast ratio, an increasing function of thickness, reaches `target` in
/// (0, 1). Infinite where it does not within 1e12. `start` is any thickness of the expected order. Relative
/// error 1e-12.
double hiding_thickness(const std::function<double(double)>& contrast, double start, double target = kHidden);

/// The same of one wavelength.
double hiding_thickness(Coefficients c, const Surface& surface = {}, double target = kHidden,
                        double black = 0, double white = 0.8);

/// Tinting strength of a paint relative to a standard, from tints of both with equal shares in the same
/// white: the ratio of what they add to the white's K/S, at the wavelength of the strongest absorption or
/// summed over wavelengths.
double tinting_strength(double sample_k_over_s, double standard_k_over_s, double white_k_over_s);

}  // namespace aureole::pigment
