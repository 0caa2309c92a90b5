// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that samplers share.
#pragma once

#include <string_view>
#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// The rows common to all samplers.
std::vector<ParameterDoc> sampler_parameters();
/// Whether `name` is one of them: they stay when another sampler takes the place, and belong to a render, not
/// to its scene.
bool is_sampler_parameter(std::string_view name);

}  // namespace aureole
