// SPDX-License-Identifier: Apache-2.0
// Numerical checks that every BSDF and phase function should pass: samples follow the pdf (chi-square), pdfs
// integrate to one, no energy is gained, reciprocity, consistency between wavelengths, and finite values at
// grazing incidence and for extreme random numbers.
#pragma once

#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"
#include "aureole/instrument/check/scattering_function.h"

namespace aureole {

/// Throws Error if the options are invalid, and passes on exceptions of `progress`.
CheckResult check_scattering(const ScatteringFunction& function, const CheckOptions& options);

}  // namespace aureole
