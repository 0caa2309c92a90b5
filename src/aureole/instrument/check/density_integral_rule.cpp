// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_density_integral(CheckRun& run, const Experiment& e) {
  const CheckOptions& options = run.options();
  const double n = double(options.samples), none = double(e.none);
  double mass = e.bins.mass();
  for (const DeltaLobe& d : e.deltas) mass += d.mass[0];

  CheckFinding finding{CheckRule::density_integral, e.wi, e.nm};
  finding.figure = mass;
  finding.expected = options.may_fail ? 1 - none / n : 1;
  finding.limit = options.tolerance + (options.may_fail ? 5 * std::sqrt(none + 1) / n : 0);
  const double error = std::abs(mass - finding.expected);
  CheckResult& result = run.result();
  result.largest_mass_error = std::max(result.largest_mass_error, error);
  if (!options.may_fail && e.none) {
    finding.passed = false;
    finding.message = sentence("`sample` returned nothing ", e.none, " times, ", e.where);
  } else if (!(error <= finding.limit)) {
    finding.passed = false;
    finding.message =
        sentence("densities and masses add up to ", mass, " instead of ", finding.expected, ", ", e.where);
  }
  run.add(std::move(finding));
}

}  // namespace aureole::check
