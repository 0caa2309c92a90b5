// SPDX-License-Identifier: Apache-2.0
// `Weight`: the linear map from light that enters a stretch of a path to light that leaves it. Weights are
// composed here and in PathDensity, and nowhere else, so that a type whose products do not commute (Mueller
// matrices) can take its place.
#pragma once

#include "aureole/spectrum/spectrum.h"

namespace aureole {

class Weight {
public:
  Weight() : factor_(1.f) {}
  explicit Weight(const Spectrum& factor) : factor_(factor) {}

  /// Light after this weight.
  Spectrum of(const Spectrum& light) const { return factor_ * light; }
  /// The weight of passing `first` and then this.
  Weight after(const Weight& first) const { return Weight(factor_ * first.factor_); }
  Weight scaled(const Spectrum& s) const { return Weight(factor_ * s); }
  /// The largest factor, without its sign, by which unpolarised light can be multiplied.
  float largest() const { return max_component(abs(factor_)); }
  bool is_black() const { return aureole::is_black(factor_); }

private:
  Spectrum factor_;
};

}  // namespace aureole
