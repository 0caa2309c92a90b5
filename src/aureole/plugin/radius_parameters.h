// SPDX-License-Identifier: Apache-2.0
// The radii of particles, as parameters of plug-ins give them.
#pragma once

#include <vector>

#include "aureole/optics/particle/radius_distribution.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// The distribution that the rows of `radius_docs` describe, in metres. Errors
/// are located at a parameter.
optics::RadiusDistribution read_radii(const Properties& properties);

std::vector<ParameterDoc> radius_docs();

}  // namespace aureole
