// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_chi_square(CheckRun& run, const Experiment& e) {
  if (!e.smooth && !(e.bins.mass() > 1e-6)) return;
  const std::size_t samples = run.options().samples;
  const double n = double(samples);
  const ChiSquareResult r = chi_square_test(e.bins.masses(), e.counts, samples, std::max(5.0, n / 2000));
  CheckFinding finding{CheckRule::chi_square, e.wi, e.nm};
  finding.figure = r.statistic;
  finding.expected = double(r.bins) - 1;
  finding.p_value = r.p_value;
  finding.limit = run.level();
  finding.passed = r.p_value >= run.level();
  if (!finding.passed)
    finding.message =
        sentence("chi-square ", r.statistic, " in ", r.bins, " bins, p = ", r.p_value, ", ", e.where);
  run.add(std::move(finding));

  CheckResult::Histogram histogram{e.wi, e.nm, e.hero, samples, r.p_value, r.statistic, r.bins, {}};
  histogram.bins.reserve(e.counts.size());
  for (std::size_t i = 0; i < e.counts.size(); ++i) {
    const DirectionBins::Bin& b = e.bins.bins()[i];
    histogram.bins.push_back({b.center, float(b.size), float(b.mass * n), float(e.counts[i])});
  }
  run.result().histograms.push_back(std::move(histogram));
}

}  // namespace aureole::check
