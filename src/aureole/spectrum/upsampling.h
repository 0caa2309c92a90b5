// SPDX-License-Identifier: Apache-2.0
// Smooth spectra of sRGB colours: W. Jakob and J. Hanika, "A Low-Dimensional Function Space for Efficient
// Spectral Upsampling", Computer Graphics Forum 38(2), 2019. Colours are linear sRGB under illuminant D65.
#pragma once

#include <algorithm>
#include <cmath>

namespace aureole {

/// A reflectance in [0, 1]: s(l) = 1/2 + x / (2 sqrt(1 + x^2)), x = c0 l^2 + c1 l + c2, with the wavelength l
/// in nm (eq. 3 and 4 of the paper). Outside 360-830 nm it keeps the value at the limit.
struct SigmoidPolynomial {
  static constexpr float kMinNm = 360.f, kMaxNm = 830.f;

  /// A constant x that makes s exactly 0 (or 1, with a plus sign) in single precision without an infinite
  /// coefficient: the square is still finite, the tail underflows.
  static constexpr float kSaturated = 1.5e19f;

  float c0 = 0, c1 = 0, c2 = -kSaturated;

  /// s at a wavelength in nm, branch-free. The tail is computed without cancellation, so that dark colours
  /// keep their relative precision.
  float at(float lambda_nm) const {
    const float l = std::min(std::max(lambda_nm, kMinNm), kMaxNm);
    const float x = (c0 * l + c1) * l + c2;
    const float root = std::sqrt(1.f + x * x);
    const float tail = 0.5f / (root * (root + std::abs(x)));
    return x < 0.f ? tail : 1.f - tail;
  }
};

/// The reflectance of a linear sRGB colour, from a table (`upsampling_table.S`). Components outside [0, 1]
/// and NaN are clamped. Greys, black and white are exact: constant spectra. Other colours return to sRGB
/// within Delta E 0.25 (mean 0.03) and 3e-3 in a component (tests/spectrum/upsampling_test.cpp). `fit_srgb`
/// is exact to Delta E 2e-3 but some 500 times slower (20 us); it suits single colours, such as those of a
/// scene file.
SigmoidPolynomial upsample_srgb(float r, float g, float b);

/// A spectrum scale * polynomial, which may exceed one.
struct UnboundedRgb {
  SigmoidPolynomial polynomial;
  float scale = 0;

  float at(float lambda_nm) const { return scale * polynomial.at(lambda_nm); }
};

/// The spectrum of an unbounded colour, such as that of an emitter (which also multiplies it by D65). The
/// colour is divided by scale = 2 max(r, g, b), so that its largest component becomes 1/2, where spectra are
/// smooth. Mitsuba 3 does the same. Negative components and NaN count as 0; black has scale 0.
UnboundedRgb upsample_unbounded(float r, float g, float b);

}  // namespace aureole
