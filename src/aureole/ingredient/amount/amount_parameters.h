// SPDX-License-Identifier: Apache-2.0
// Reads the concentration of an ingredient's particles from parameters.
#pragma once

#include <vector>

#include "aureole/optics/medium/suspension_model.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Reads exactly one of "number_density", "volume_fraction" and "mass_fraction". Errors are located.
optics::Amount read_amount(const Properties& properties);

/// Returns the density of the particles' material in kg/m^3; 0 if not given.
double read_density(const Properties& properties);

/// Returns the documentation of these parameters.
std::vector<ParameterDoc> amount_docs();

}  // namespace aureole
