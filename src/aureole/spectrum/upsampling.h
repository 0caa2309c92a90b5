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

  /// Returns s at a wavelength in nm, branch-free. The tail is computed without cancellation, so that dark
  /// colours keep their relative precision.
  float at(float lambda_nm) const {
    const float l = std::min(std::max(lambda_nm, kMinNm), kMaxNm);
    const float x = (c0 * l + c1) * l + c2;
    const float root = std::sqrt(1.f + x * x);
    const float tail = 0.5f / (root * (root + std::abs(x)));
    return x < 0.f ? tail : 1.f - tail;
  }
};

/// A scaled sigmoid polynomial S: the spectrum scale * S, or 1 - |scale| S where the scale is negative. The
/// second form is for light colours: their difference from white, 1 - (r, g, b), is small, and so is |scale|.
struct SigmoidSpectrum {
  SigmoidPolynomial polynomial;
  float scale = 0;

  float offset() const { return scale < 0.f ? 1.f : 0.f; }
  float at(float lambda_nm) const { return scale * polynomial.at(lambda_nm) + offset(); }
};

/// The scale k of a reflectance's difference from white: its spectrum is 1 - k S, where S has the colour
/// (1 - (r, g, b)) / k. With m = 1 - min(r, g, b), k = 4m/3 + 0.6 (m / 0.3)^4 up to m = 0.3, and 1 from there
/// on. So the spectrum lies in [1 - k, 1], and a colour that is nearly white has a spectrum that is nearly
/// flat: there the largest component of the colour of S is 3/4, where sigmoids are smooth. Where k = 1, 1 - S
/// is a sigmoid itself, the model of Jakob and Hanika. That model alone lets the spectrum of (0.99, 0.999,
/// 0.99) fall to 0.34 at 700 nm, because the observer hardly sees that end.
template <class Real>
Real scale_below_white(Real r, Real g, Real b) {
  const Real m = Real(1) - std::min({r, g, b});
  const Real q = m * Real(1 / 0.3);
  return q < Real(1) ? Real(0.4) * q + Real(0.6) * (q * q) * (q * q) : Real(1);
}

/// The reflectance of a linear sRGB colour, from a table (`upsampling_table.S`). Components outside [0, 1]
/// and NaN are clamped. Greys, black and white are exact: constant spectra. Other colours return to sRGB
/// within Delta E 0.25 (CIE 1976; mean 0.03) and 3e-3 in a component (tests/spectrum/upsampling_test.cpp).
/// Colours near white have flat spectra (`scale_below_white`). `fit_srgb` is exact to Delta E 2e-3 but some
/// 500 times slower (20 us); it suits single colours, such as those of a scene file.
SigmoidSpectrum upsample_srgb(float r, float g, float b);

/// The spectrum of an unbounded colour, such as that of an emitter (which also multiplies it by D65). The
/// colour is divided by scale = 2 max(r, g, b), so that its largest component becomes 1/2, where spectra are
/// smooth. Mitsuba 3 does the same. Negative components and NaN count as 0; black has scale 0.
SigmoidSpectrum upsample_unbounded(float r, float g, float b);

}  // namespace aureole
