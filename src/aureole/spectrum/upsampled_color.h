// SPDX-License-Identifier: Apache-2.0
// A compact upsampled colour for large arrays (texels, vertices), evaluated at all wavelengths of a path at
// once.
#pragma once

#include <algorithm>
#include <utility>

#include "aureole/spectrum/spectrum.h"
#include "aureole/spectrum/upsampling.h"

namespace aureole {

/// A sigmoid polynomial times a scale, which is one for colours in [0, 1].
struct alignas(16) UpsampledColor {
  float c0 = 0, c1 = 0, c2 = 0, scale = 0;

  bool operator==(const UpsampledColor&) const = default;

  static UpsampledColor of_rgb(float r, float g, float b) {
    if (std::max({r, g, b}) <= 1) {
      const SigmoidPolynomial p = upsample_srgb(r, g, b);
      return {p.c0, p.c1, p.c2, 1};
    }
    return of_unbounded(upsample_unbounded(r, g, b));
  }
  /// Like `of_rgb`, but black always has all members 0, so that its many representations compare equal.
  static UpsampledColor of_rgb_or_black(float r, float g, float b) {
    return std::max({r, g, b}) > 0 ? of_rgb(r, g, b) : UpsampledColor{};
  }
  static UpsampledColor of_unbounded(const UnboundedRgb& u) {
    return {u.polynomial.c0, u.polynomial.c1, u.polynomial.c2, u.scale};
  }
  /// Clamps wavelengths to the model's range, outside of which the spectrum is constant.
  static Spectrum model_range(const Spectrum& nm) {
    return min(max(nm, SigmoidPolynomial::kMinNm), SigmoidPolynomial::kMaxNm);
  }
  Spectrum eval(const Spectrum& nm) const { return shape(nm) * scale; }
  /// SigmoidPolynomial::at for all wavelengths, which must lie in the model's range.
  Spectrum shape(const Spectrum& nm) const {
    const Spectrum x = (nm * c0 + c1) * nm + c2;
    const Spectrum root = sqrt(Spectrum(1.f) + x * x);
    const Spectrum tail = Spectrum(0.5f) / (root * (root + abs(x)));
    return select(x.v < Spectrum(0.f).v, tail, Spectrum(1.f) - tail);
  }
  /// Smallest and largest value over the wavelengths. The sigmoid is monotonic and its argument a parabola.
  std::pair<float, float> range() const {
    const SigmoidPolynomial p{c0, c1, c2};
    const float a = p.at(SigmoidPolynomial::kMinNm), b = p.at(SigmoidPolynomial::kMaxNm);
    const float vertex = c0 != 0 ? p.at(-c1 / (2 * c0)) : a;  // clamped to the range by `at`
    return {scale * std::min({a, b, vertex}), scale * std::max({a, b, vertex})};
  }
};

}  // namespace aureole
