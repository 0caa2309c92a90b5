// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/bsdf/near_field.h"
#include "aureole/instrument/check/rules.h"

namespace aureole::check {

void check_modes_of_deltas(CheckRun& run, const Vec3& wi) {
  if (!run.options().reciprocal) return;
  CheckFinding finding{CheckRule::modes, wi, run.nm(0)};
  finding.limit = 1e-3;
  const std::vector<DeltaLobe> importance = run.delta_lobes(wi, {0, TransportMode::importance});
  const std::vector<DeltaLobe> radiance = run.delta_lobes(wi, {0, TransportMode::radiance});
  if (importance.empty() && radiance.empty()) return;
  if (importance.size() != radiance.size())
    return run.fail(finding, "the modes have different delta lobes for wi = ", to_text(wi));
  for (std::size_t k = 0; k < importance.size(); ++k) {
    // Light of a null lobe stays in the same medium.
    const bool null = has(importance[k].lobe, Lobe::null);
    const double ratio = null ? 1 : run.index(wi, 0) / run.index(importance[k].wo, 0);
    const double d = deviation(radiance[k].value[0], importance[k].value[0] * ratio * ratio, 1e-6);
    finding.figure = std::max(finding.figure, d);
    if (!(d <= finding.limit))
      return run.fail(finding, "a delta lobe carries ", radiance[k].value[0], " in radiance mode and ",
                      importance[k].value[0], " in importance mode, for wi = ", to_text(wi));
  }
  run.add(std::move(finding));
}

void check_modes(CheckRun& run, const DirectionPairs& pairs) {
  if (has(run.function().lobes(), kNearField)) return;
  CheckFinding finding{CheckRule::modes};
  finding.limit = 2e-3;
  for (std::size_t k = 0; k < pairs.wi.size(); ++k)
    for (int j = 0; j < kWavelengths; ++j) {
      const double backward = pairs.backward[k][j] / run.function().area(pairs.wi[k]);
      const double adjoint = pairs.adjoint[k][j] / run.function().area(pairs.wo[k]);
      const double d = deviation(adjoint, backward, 1e-6);
      if (!is_worse(d, finding.figure)) continue;
      finding.figure = d;
      if (d <= finding.limit) continue;
      finding.passed = false;
      finding.wi = pairs.wi[k], finding.nm = run.nm(j);
      finding.message =
          sentence("importance mode gives ", adjoint, " for wi -> wo, radiance mode ", backward,
                   " for the same light; wi = ", to_text(pairs.wi[k]), ", wo = ", to_text(pairs.wo[k]));
    }
  run.add(std::move(finding));
}

}  // namespace aureole::check
