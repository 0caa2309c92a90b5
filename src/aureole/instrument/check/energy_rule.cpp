// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

std::array<double, kWavelengths> check_energy(CheckRun& run, const Vec3& wi, int hero,
                                              const DirectionBins& bins) {
  const CheckOptions& options = run.options();
  CheckResult& result = run.result();
  CheckResult::Energy e{wi, {}, bins.other(), true};
  CheckFinding finding{CheckRule::energy, wi};
  finding.expected = options.largest_energy;
  finding.limit = options.tolerance;
  // A non-reciprocal function conserves energy in one mode only.
  e.bounded = options.reciprocal || options.mode == TransportMode::radiance;
  double worst = -1;
  for (int j = 0; j < kWavelengths; ++j) {
    const std::size_t k = std::size_t(j);
    for (const DeltaLobe& d : run.delta_lobes(wi, run.query((hero + j) % kWavelengths)))
      e.energy[k] += d.value[0];
    const double energy = e.energy[k];
    e.nm[k] = run.function().wavelengths(hero).nm[j];
    result.largest_energy = std::max(result.largest_energy, energy);
    result.smallest_energy = std::min(result.smallest_energy, energy);
    const double gain = e.bounded ? energy - options.largest_energy : 0,
                 loss = options.lossless ? 1 - energy : 0;
    const double wrong = std::isnan(energy) ? HUGE_VAL : std::max(gain, loss);
    if (worst >= 0 && wrong <= worst) continue;
    worst = std::max(wrong, 0.0);
    finding.figure = energy;
    finding.nm = e.nm[k];
    finding.passed = wrong <= options.tolerance;
    if (!finding.passed) {
      finding.expected = loss > gain ? 1 : options.largest_energy;
      finding.message = sentence(loss > gain ? "loses" : "gains", " energy: ", energy, " at ", e.nm[k],
                                 " nm, wi = ", to_text(wi));
    }
  }
  run.add(std::move(finding));
  result.energies.push_back(e);
  return e.energy;
}

}  // namespace aureole::check
