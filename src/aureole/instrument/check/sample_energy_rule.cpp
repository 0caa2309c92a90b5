// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_sample_energy(CheckRun& run, const Experiment& e, double energy) {
  const double n = double(run.options().samples);
  const double mean_weight = e.weight / n;
  const double variance = std::max(e.weight2 / n - mean_weight * mean_weight, 0.0) / n;
  CheckFinding finding{CheckRule::sample_energy, e.wi, e.nm};
  finding.figure = mean_weight;
  finding.expected = energy;
  // The p-value allows for errors of quadrature and of single precision.
  finding.p_value =
      normal_p_value(std::max(std::abs(mean_weight - energy) - 1e-4, 0.0) / std::sqrt(variance + 1e-12));
  finding.limit = run.level();
  finding.passed = finding.p_value >= run.level();
  if (!finding.passed)
    finding.message = sentence("samples carry the energy ", mean_weight, ", eval has ", energy,
                               " (p = ", finding.p_value, "), ", e.where);
  run.add(std::move(finding));
}

}  // namespace aureole::check
