// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that films share.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// The rows common to all films, but for the wavelengths, followed by `own`.
std::vector<ParameterDoc> film_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
