// SPDX-License-Identifier: Apache-2.0
// A rough dielectric interface over a diffuse base, for `roughplastic` and `paint`.
#pragma once

#include <algorithm>
#include <vector>

#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/core/table_fields.h"

namespace aureole {

/// The coating's transmittance from outside as a function of the cosine, and derived quantities, for one
/// index.
struct RoughCoating {
  static constexpr int kCells = 128;

  float transmittance[kCells + 1] = {};
  float f_int = 0, leaving = 0;  ///< fractions of diffuse light from below that are reflected and that leave

  static constexpr TableKind kTable{"rough coating", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.transmittance, self.f_int, self.leaving);
  }

  /// An empty table, to be read.
  RoughCoating() = default;
  /// With `energy_preserving`, transmits all light that is not reflected once; else only light transmitted
  /// once.
  RoughCoating(const Microfacets& d, double eta, bool energy_preserving);

  float at(float mu) const {
    const float x = std::min(mu, 1.f) * kCells;
    const int i = std::min(int(x), kCells - 1);
    return transmittance[i] + (transmittance[i + 1] - transmittance[i]) * (x - float(i));
  }
};

/// The coating for the smallest index and, where the index depends on the wavelength, for the largest.
struct RoughCoatings {
  std::vector<RoughCoating> by_index;

  static constexpr TableKind kTable{"rough coatings", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.by_index);
  }
};

}  // namespace aureole
