// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

bool is_black(const DirectionBins& bins) {
  const auto energy = bins.other();
  return bins.mass() == 0 && std::all_of(energy.begin(), energy.end(), [](double e) { return e == 0; });
}

void note_black(CheckRun& run, const Experiment& e, bool passed) {
  CheckFinding finding{CheckRule::black, e.wi, e.nm};
  finding.passed = passed;
  if (!passed) finding.message = "it is not black from below, " + e.where;
  run.add(std::move(finding));
  if (!passed) return;
  run.result().black_below |= e.wi.z < 0;
  CheckResult::Energy energy{e.wi, {}, {}, true};
  for (int j = 0; j < kWavelengths; ++j) energy.nm[std::size_t(j)] = run.nm(j);
  run.result().energies.push_back(energy);
}

}  // namespace aureole::check
