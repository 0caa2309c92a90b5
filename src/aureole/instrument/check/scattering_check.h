// SPDX-License-Identifier: Apache-2.0
// The rules that every BSDF and phase function has to follow, checked by numbers: samples follow the density
// (chi-square), densities add up to one, no energy is gained, reciprocity, wavelengths that agree about each
// other, finite values at grazing and at the ends of the random numbers.
#pragma once

#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"
#include "aureole/instrument/check/scattering_function.h"

namespace aureole {

/// Throws Error where the options make no sense, and whatever `progress` throws.
CheckResult check_scattering(const ScatteringFunction& function, const CheckOptions& options);

}  // namespace aureole
