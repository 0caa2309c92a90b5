// SPDX-License-Identifier: Apache-2.0
// Delta lobes as sampling finds them.
#pragma once

#include <cstddef>
#include <vector>

#include "aureole/bsdf/bsdf.h"

namespace aureole::check {

struct DeltaLobe {
  Lobe lobe;
  Vec3 wo;
  Spectrum value, mass;
  std::size_t count = 0;  ///< samples
};

/// Blends may have several delta lobes in one direction, of which each is drawn and reported alone: a lobe is
/// its kind, direction, mass and value.
bool is_same(const DeltaLobe& lobe, const BsdfSample& sample);

/// Counts a delta sample for its lobe, which is added where it is new.
void gather(std::vector<DeltaLobe>& lobes, const BsdfSample& sample);

}  // namespace aureole::check
