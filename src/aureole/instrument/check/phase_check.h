// SPDX-License-Identifier: Apache-2.0
// Applies the checks of scattering functions (scattering_check.h) to a phase function.
#pragma once

#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"
#include "aureole/phase/phase.h"

namespace aureole {

/// Checks a phase function. The options `lossless` and `black_below` are ignored, because a phase function
/// scatters all light, from every side. Reciprocity applies to the value times the projected area for wi. `p`
/// is the point in a spatially varying medium. Throws Error if the options are invalid, and passes on
/// exceptions of `progress`.
CheckResult check_phase(const PhaseFunction& phase, const CheckOptions& options, const Vec3& p = {});

}  // namespace aureole
