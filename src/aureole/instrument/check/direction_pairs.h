// SPDX-License-Identifier: Apache-2.0
// Pairs of directions with the values compared by the rules on exchanged directions.
#pragma once

#include <vector>

#include "aureole/instrument/check/check_run.h"

namespace aureole::check {

/// Pairs of directions and their values, which include the cosine of the second direction.
struct DirectionPairs {
  std::vector<Vec3> wi, wo;
  std::vector<Spectrum> forward;   ///< f(wi, wo) in radiance mode
  std::vector<Spectrum> backward;  ///< f(wo, wi) in radiance mode
  std::vector<Spectrum> adjoint;   ///< f(wi, wo) in importance mode
};

/// Makes pairs of directions over both hemispheres; every second pair has a sampled direction if there is
/// one. Pairs at grazing angles are excluded, because a quotient of cosines is inaccurate there.
DirectionPairs make_direction_pairs(CheckRun& run);

}  // namespace aureole::check
