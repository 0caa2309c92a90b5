// SPDX-License-Identifier: Apache-2.0
// Options of the instruments that measure a material of a scene.
#pragma once

#include <string>

namespace aureole {

/// Reads an option's length with a unit into metres; an empty text leaves the value. Throws Error with the option's name.
void set_length(const char* option, const std::string& text, double& metres);

}  // namespace aureole
