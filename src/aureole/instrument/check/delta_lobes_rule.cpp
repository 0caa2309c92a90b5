// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_delta_masses(CheckRun& run, const Experiment& e) {
  const std::size_t samples = run.options().samples;
  for (const DeltaLobe& d : e.deltas) {
    CheckFinding finding{CheckRule::delta_lobes, e.wi, e.nm};
    finding.figure = double(d.count) / double(samples);
    finding.expected = d.mass[0];
    finding.p_value = binomial_p_value(d.count, samples, std::min(double(d.mass[0]), 1.0));
    finding.limit = run.level();
    finding.passed = finding.p_value >= run.level();
    if (!finding.passed)
      finding.message = sentence("a delta lobe of mass ", d.mass[0], " was sampled ", d.count, " times of ",
                                 samples, " (p = ", finding.p_value, "), ", e.where);
    run.add(std::move(finding));
  }
}

}  // namespace aureole::check
