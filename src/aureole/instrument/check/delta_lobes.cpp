// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/delta_lobes.h"

#include "aureole/instrument/check/deviation.h"

namespace aureole::check {

bool is_same(const DeltaLobe& a, const BsdfSample& s) {
  return a.lobe == s.lobe && length(a.wo - s.wo) < 1e-6f && are_close(a.mass[0], s.pdf[0], 1e-5, 0) &&
         are_close(a.value[0], s.value[0], 1e-5, 0);
}

void gather(std::vector<DeltaLobe>& lobes, const BsdfSample& s) {
  for (DeltaLobe& l : lobes)
    if (is_same(l, s)) {
      ++l.count;
      return;
    }
  lobes.push_back({s.lobe, s.wo, s.value, s.pdf, 1});
}

}  // namespace aureole::check
