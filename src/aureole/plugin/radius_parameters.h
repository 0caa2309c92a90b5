// SPDX-License-Identifier: Apache-2.0
// The radius distribution of particles, as parameters of plug-ins.
#pragma once

#include <vector>

#include "aureole/optics/particle/radius_distribution.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Returns the distribution, in metres, of the parameters that `radius_docs` describes. Errors are located at
/// a parameter.
optics::RadiusDistribution read_radii(const Properties& properties);

std::vector<ParameterDoc> radius_docs();

}  // namespace aureole
