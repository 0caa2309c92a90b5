// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/microfacet/rough_coating.h"

#include <cmath>

#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/core/parallel.h"

namespace aureole {

RoughCoating::RoughCoating(const Microfacets& d, double eta, bool energy_preserving) {
  // Normals of Beckmann's distribution take four times as long to sample, and 610 points are as accurate for them as
  // 987 for others: 1e-3 at most.
  const int points = d.type() == NormalDistribution::beckmann ? 610 : 987;
  for_ranges(
      kCells + 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const float mu = std::max(float(i) / kCells, 1e-5f);
          const ScatteredEnergy e =
              scattered_energy(d, {std::sqrt((1 - mu) * (1 + mu)), 0, mu}, float(eta), points);
          transmittance[i] = float(energy_preserving ? 1 - e.reflected : e.transmitted);
        }
      },
      16);
  // The integral of 2 T mu over linear segments.
  double mean = 0;
  for (int i = 0; i < kCells; ++i) {
    const double a = transmittance[i], b = transmittance[i + 1], h = 1.0 / kCells, mu = i * h;
    mean += h * ((a + b) * mu + h * (a + 2 * b) / 3);
  }
  leaving = float(mean / (eta * eta));
  f_int = energy_preserving ? 1 - leaving : float(diffuse_scattered_energy(d, float(1 / eta)).reflected);
}

}  // namespace aureole
