// SPDX-License-Identifier: Apache-2.0
// The rules of scattering functions (scattering_check.h), applied to a phase function.
#pragma once

#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"
#include "aureole/phase/phase.h"

namespace aureole {

/// The options `lossless` and `black_below` do not matter: all light that a phase function takes goes
/// somewhere, from whatever side. Reciprocity is that of value times the area shown to wi. `p` is the point
/// of a medium that varies in space. Throws Error where the options make no sense, and whatever `progress`
/// throws.
CheckResult check_phase(const PhaseFunction& phase, const CheckOptions& options, const Vec3& p = {});

}  // namespace aureole
