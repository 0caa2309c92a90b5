// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/microfacet/rough_coating.h"

#include <cmath>

#include "aureole/bsdf/microfacet/microfacet_energy.h"

namespace aureole {

RoughCoating::RoughCoating(const Microfacets& d, double eta, bool energy_preserving) {
  for (int i = 0; i <= kCells; ++i) {
    const float mu = std::max(float(i) / kCells, 1e-5f);
    const ScatteredEnergy e = scattered_energy(d, {std::sqrt((1 - mu) * (1 + mu)), 0, mu}, float(eta), 987);
    transmittance[i] = float(energy_preserving ? 1 - e.reflected : e.transmitted);
  }
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
