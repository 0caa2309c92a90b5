// SPDX-License-Identifier: Apache-2.0
// Delta lobes, found by sampling.
#pragma once

#include <cstddef>
#include <vector>

#include "aureole/bsdf/bsdf.h"

namespace aureole::check {

struct DeltaLobe {
  Lobe lobe;
  Vec3 wo;
  Spectrum value, mass;
  std::size_t count = 0;  ///< number of samples in the lobe
};

/// Whether the sample belongs to the lobe. A lobe is identified by type, direction, mass and value, because
/// blends may have several delta lobes in one direction, each sampled separately.
bool is_same(const DeltaLobe& lobe, const BsdfSample& sample);

/// Counts a delta sample for its lobe, and adds the lobe if it is new.
void gather(std::vector<DeltaLobe>& lobes, const BsdfSample& sample);

}  // namespace aureole::check
