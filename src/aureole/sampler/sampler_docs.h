// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that samplers share.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// The rows common to all samplers.
std::vector<ParameterDoc> sampler_parameters();

}  // namespace aureole
