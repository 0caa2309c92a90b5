// SPDX-License-Identifier: Apache-2.0
// How much of its particles an ingredient has, as parameters give it.
#pragma once

#include <vector>

#include "aureole/optics/medium/suspension_model.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Exactly one of "number_density", "volume_fraction" and "mass_fraction". Errors are located.
optics::Amount read_amount(const Properties& properties);

/// Density of the particles' material in kg/m^3; 0 where none is stated.
double read_density(const Properties& properties);

/// The rows of these parameters.
std::vector<ParameterDoc> amount_docs();

}  // namespace aureole
