// SPDX-License-Identifier: Apache-2.0
// A compact upsampled colour for large arrays (texels, vertices), evaluated at all wavelengths of a path at
// once.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "aureole/spectrum/spectrum.h"
#include "aureole/spectrum/upsampling.h"
#include "aureole/spectrum/value_limit.h"

namespace aureole {

/// A `SigmoidSpectrum` in 16 bytes: scale * S, or 1 - |scale| S where the scale is negative, which is for
/// light colours in [0, 1].
struct alignas(16) UpsampledColor {
  float c0 = 0, c1 = 0, c2 = 0, scale = 0;

  bool operator==(const UpsampledColor&) const = default;

  static UpsampledColor of_rgb(float r, float g, float b) {
    const float largest = std::max({r, g, b});
    // the excess is rounding, and no other spectrum is needed
    if (largest > 1 && largest <= 1 + float(kLimitNoise))
      r = std::min(r, 1.f), g = std::min(g, 1.f), b = std::min(b, 1.f);
    else if (largest > 1)
      return of(upsample_unbounded(r, g, b));
    return of(upsample_srgb(r, g, b));
  }
  /// Like `of_rgb`, but black always has all members 0, so that its many representations compare equal.
  static UpsampledColor of_rgb_or_black(float r, float g, float b) {
    return std::max({r, g, b}) > 0 ? of_rgb(r, g, b) : UpsampledColor{};
  }
  static UpsampledColor of(const SigmoidSpectrum& s) {
    return {s.polynomial.c0, s.polynomial.c1, s.polynomial.c2, s.scale};
  }
  /// Clamps wavelengths to the model's range, outside of which the spectrum is constant.
  static Spectrum model_range(const Spectrum& nm) {
    return min(max(nm, SigmoidPolynomial::kMinNm), SigmoidPolynomial::kMaxNm);
  }
  float offset() const { return scale < 0 ? 1.f : 0.f; }
  Spectrum eval(const Spectrum& nm) const { return shape(nm) * scale + offset(); }
  /// Returns the sigmoid, as SigmoidPolynomial::at, for all wavelengths, which must lie in the model's range.
  Spectrum shape(const Spectrum& nm) const {
    const Spectrum x = (nm * c0 + c1) * nm + c2;
    const Spectrum root = sqrt(Spectrum(1.f) + x * x);
    const Spectrum tail = Spectrum(0.5f) / (root * (root + abs(x)));
    return select(x.v < Spectrum(0.f).v, tail, Spectrum(1.f) - tail);
  }
  /// Returns the smallest and largest value over all wavelengths, or over an interval of the model's range.
  /// The sigmoid is monotonic and its argument a parabola.
  std::pair<float, float> range(float from_nm = SigmoidPolynomial::kMinNm,
                                float to_nm = SigmoidPolynomial::kMaxNm) const {
    const SigmoidPolynomial p{c0, c1, c2};
    const float a = p.at(from_nm), b = p.at(to_nm);
    const float vertex = c0 != 0 ? p.at(std::min(std::max(-c1 / (2 * c0), from_nm), to_nm)) : a;
    const float low = scale * std::min({a, b, vertex}), high = scale * std::max({a, b, vertex});
    return scale < 0 ? std::pair(1 + high, 1 + low) : std::pair(low, high);
  }
};

/// The range of the values of many colours over all wavelengths.
class ColorRange {
public:
  void extend(const UpsampledColor& color) {
    if (color.scale != 1) {
      const auto [low, high] = color.range();
      return extend(low, high);
    }
    // The sigmoid is monotonic, so that its arguments, which are cheaper to compute, are compared.
    constexpr float kFrom = SigmoidPolynomial::kMinNm, kTo = SigmoidPolynomial::kMaxNm;
    const auto argument = [&](float nm) { return (color.c0 * nm + color.c1) * nm + color.c2; };
    const float a = argument(kFrom), b = argument(kTo);
    lowest_argument_ = std::min({lowest_argument_, a, b});
    highest_argument_ = std::max({highest_argument_, a, b});
    if ((2 * color.c0 * kFrom + color.c1) * (2 * color.c0 * kTo + color.c1) < 0) {
      const float vertex = argument(-color.c1 / (2 * color.c0));
      lowest_argument_ = std::min(lowest_argument_, vertex);
      highest_argument_ = std::max(highest_argument_, vertex);
    }
  }
  void extend(float low, float high) { low_ = std::min(low_, low), high_ = std::max(high_, high); }
  void extend(const ColorRange& other) {
    extend(other.low_, other.high_);
    lowest_argument_ = std::min(lowest_argument_, other.lowest_argument_);
    highest_argument_ = std::max(highest_argument_, other.highest_argument_);
  }
  /// Returns the smallest and largest value; infinite, the larger one first, if there are none.
  std::pair<float, float> values() const {
    if (!(lowest_argument_ <= highest_argument_)) return {low_, high_};
    const auto value = [](float argument) { return SigmoidPolynomial{0, 0, argument}.at(0); };
    return {std::min(low_, value(lowest_argument_)), std::max(high_, value(highest_argument_))};
  }

private:
  float low_ = std::numeric_limits<float>::infinity(), high_ = -low_;
  /// range of the arguments of sigmoids, for colours of scale 1
  float lowest_argument_ = low_, highest_argument_ = high_;
};

}  // namespace aureole
