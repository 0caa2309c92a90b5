// SPDX-License-Identifier: Apache-2.0
// Second stage of loading: renames and restructures nodes of files from before version 2.0.0 (Mitsuba 0.6) to
// the current format.
#pragma once

#include <string>
#include <string_view>

#include "aureole/loading/node.h"

namespace aureole {

/// Upgrades `node` and everything below it. Adds a note for every element that is dropped or replaced.
void upgrade(Node& node, Diagnostics& diagnostics);

/// Converts "toWorld" to "to_world" and "intIOR" to "int_ior": inserts an underscore where lower case
/// precedes upper case, then makes everything lower case.
std::string snake_case(std::string_view camel_case);

}  // namespace aureole
