// SPDX-License-Identifier: Apache-2.0
// Pairs of directions with the values that the rules about exchanged directions compare.
#pragma once

#include <vector>

#include "aureole/instrument/check/check_run.h"

namespace aureole::check {

/// Values include the cosine of the second direction.
struct DirectionPairs {
  std::vector<Vec3> wi, wo;
  std::vector<Spectrum> forward;   ///< f(wi, wo) in radiance mode
  std::vector<Spectrum> backward;  ///< f(wo, wi) in radiance mode
  std::vector<Spectrum> adjoint;   ///< f(wi, wo) in importance mode
};

/// Pairs over both spheres, every second one with a sampled direction where there is one. Pairs that graze a
/// surface, where a quotient of cosines says nothing, are left out.
DirectionPairs make_direction_pairs(CheckRun& run);

}  // namespace aureole::check
