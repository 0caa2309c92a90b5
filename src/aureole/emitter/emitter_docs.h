// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that every emitter shares.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// `own` followed by the rows common to all emitters: sampling_weight.
std::vector<ParameterDoc> emitter_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
