// SPDX-License-Identifier: Apache-2.0
// A rough dielectric interface over a diffuse base, for `roughplastic` and `paint`.
#pragma once

#include <algorithm>

#include "aureole/bsdf/microfacet/microfacet.h"

namespace aureole {

/// The coating's transmittance from outside as a function of the cosine, and derived quantities, for one
/// index.
struct RoughCoating {
  static constexpr int kCells = 128;

  float transmittance[kCells + 1];
  float f_int, leaving;  ///< fractions of diffuse light from below that are reflected and that leave

  /// With `energy_preserving`, transmits all light that is not reflected once; else only light transmitted
  /// once.
  RoughCoating(const Microfacets& d, double eta, bool energy_preserving);

  float at(float mu) const {
    const float x = std::min(mu, 1.f) * kCells;
    const int i = std::min(int(x), kCells - 1);
    return transmittance[i] + (transmittance[i + 1] - transmittance[i]) * (x - float(i));
  }
};

}  // namespace aureole
