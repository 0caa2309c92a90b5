// SPDX-License-Identifier: Apache-2.0
// The optimisation behind spectral upsampling (Jakob and Hanika 2019, section 4), for single colours and for
// the table.
#pragma once

#include <array>

#include "aureole/spectrum/upsampling.h"

namespace aureole {

using Rgb = std::array<double, 3>;

/// A sigmoid polynomial in the normalised wavelength t = (l - 595 nm) / 235 nm, in [-1, 1] over 360-830 nm: x
/// = c[0] + c[1] t + c[2] t^2. The optimisation is well conditioned in these coefficients.
struct FitCoefficients {
  std::array<double, 3> c{};

  SigmoidPolynomial polynomial() const;
};

/// Moves `start` to the spectrum whose colour under D65 is `linear_rgb`, by damped Gauss-Newton steps on the
/// CIELAB difference. Returns the remaining difference (CIE 1976 Delta E). The nearer the start, the faster.
double refine_fit(const Rgb& linear_rgb, FitCoefficients& start);

/// Returns the sigmoid polynomial of a linear sRGB colour, clamped to [0, 1]: the model of Jakob and Hanika
/// as it was published. Greys are exact constants. The spectrum's colour is within Delta E 2e-3 of the given
/// one (rounding of the coefficients to float). Takes about 20 us.
SigmoidPolynomial fit_sigmoid(const Rgb& linear_rgb);

/// Returns the reflectance of a linear sRGB colour, clamped to [0, 1], as `upsample_srgb` does, but by a fit:
/// within Delta E 2e-3, in about 20 us. Colours near white have flat spectra (`scale_below_white`).
SigmoidSpectrum fit_srgb(const Rgb& linear_rgb);

/// Returns the spectrum of an unbounded colour, as `upsample_unbounded` does, but by a fit. Negative
/// components and NaN count as 0; components are finite.
SigmoidSpectrum fit_unbounded(const Rgb& linear_rgb);

/// The linear sRGB colour of a reflectance under D65, by the trapezoidal rule at 1 nm. The matrix has the
/// sRGB primaries (IEC 61966-2-1) and, as white, the chromaticity of the D65 table, so that the reflectance 1
/// is exactly (1, 1, 1).
Rgb srgb_of_reflectance(const SigmoidSpectrum& spectrum);

/// CIE 1976 colour difference of two linear sRGB colours under the same white.
double delta_e(const Rgb& linear_a, const Rgb& linear_b);

}  // namespace aureole
