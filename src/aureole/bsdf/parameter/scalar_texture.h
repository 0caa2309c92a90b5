// SPDX-License-Identifier: Apache-2.0
// `ScalarTexture`: a parameter that is one number for all wavelengths, such as a roughness or the weight of a
// lobe, and may vary over the surface.
#pragma once

#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/units.h"
#include "aureole/texture/texture.h"

namespace aureole {

class ScalarTexture {
public:
  /// Reads the number or grey texture of the parameter `name`. A value outside `range`, or one that differs
  /// between wavelengths, is an error located at the parameter.
  static ScalarTexture from(const Properties& properties, std::string_view name, double fallback,
                            Range range) {
    ScalarTexture s;
    s.value_ = float(fallback);
    const TexturePtr texture = get_optional_texture(properties, name, SpectrumRole::unbounded);
    if (!texture) return s;
    const SampledSpectrum average = texture->average();
    const float highest = average.maximum(), lowest = average.minimum();
    // A grey picture that is not raw is upsampled like a colour, which leaves it grey to a few parts in 10^4.
    if (!(highest - lowest <= 1e-3f * highest))
      throw properties.error(name,
                             "is one number for all wavelengths, but what is given has a colour; write a "
                             "number, or load a picture with raw = true");
    // Tolerance for rounding errors of tabulation and of image formats.
    constexpr double kTolerance = 1e-5;
    s.minimum_ = texture->minimum(), s.maximum_ = texture->maximum();
    const bool below = range.open_min ? !(s.minimum_ > range.min) : s.minimum_ < range.min - kTolerance;
    if (below || s.maximum_ > range.max + kTolerance)
      throw properties.error(name, "goes from " + shown_number(s.minimum_) + " to " +
                                       shown_number(s.maximum_) + ", but must lie " + text(range));
    s.value_ = highest;
    if (!texture->is_constant())
      s.texture_ = texture;
    else
      s.minimum_ = s.maximum_ = s.value_;
    return s;
  }

  float eval(const BsdfContext& ctx) const {
    return texture_ ? texture_->eval(ctx.point, ctx.wavelengths)[0] : value_;
  }
  bool is_textured() const { return texture_ != nullptr; }
  float maximum() const { return texture_ ? maximum_ : value_; }
  float minimum() const { return texture_ ? minimum_ : value_; }

private:
  static std::string text(const Range& range) {
    const std::string from = std::string(range.open_min ? "above " : "from ") + shown_number(range.min);
    return range.max < 1e30 ? from + " to " + shown_number(range.max)
           : range.open_min ? from
                            : from + " upwards";
  }

  TexturePtr texture_;  // texture of a varying parameter; null if it is constant
  float value_ = 0, minimum_ = 0, maximum_ = 0;
};

}  // namespace aureole
