// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_reciprocity(CheckRun& run, const DirectionPairs& pairs) {
  if (!run.options().reciprocal) return;
  CheckFinding finding{CheckRule::reciprocity};
  finding.limit = 2e-3;
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < pairs.wi.size(); ++k) {
    const Vec3 wi = pairs.wi[k], wo = pairs.wo[k];
    bool agrees = true;
    for (int j = 0; j < kWavelengths; ++j) {
      const double ni = run.index(wi, j), no = run.index(wo, j);
      const double forward = pairs.forward[k][j] / run.function().area(wo);
      const double backward = pairs.backward[k][j] / run.function().area(wi);
      const double a = forward / (ni * ni), b = backward / (no * no), d = deviation(a, b, 1e-6);
      agrees &= d <= finding.limit;
      if (is_worse(d, finding.figure)) {
        finding.figure = d;
        if (!(d <= finding.limit)) {
          finding.passed = false;
          finding.wi = wi, finding.nm = run.nm(j);
          finding.message = sentence("not reciprocal: ", a, " against ", b, " at ", finding.nm,
                                     " nm; wi = ", to_text(wi), ", wo = ", to_text(wo));
        }
      }
      if (j == 0) run.result().pairs.push_back({wi, wo, run.nm(0), a, b});
    }
    wrong += !agrees;
  }
  if (wrong)
    finding.message += sentence(" (the worst; ", wrong, " of ", pairs.wi.size(), " pairs are wrong)");
  run.add(std::move(finding));
}

}  // namespace aureole::check
