// SPDX-License-Identifier: Apache-2.0
// Second stage of loading: nodes from files of a version before 2.0.0 (Mitsuba 0.6) get today's names and
// shapes.
#pragma once

#include <string>
#include <string_view>

#include "aureole/loading/node.h"

namespace aureole {

/// Upgrades `node` and everything below it. Every element that is dropped or replaced gives a note.
void upgrade(Node& node, Diagnostics& diagnostics);

/// "toWorld" -> "to_world", "intIOR" -> "int_ior": an underscore where lower case meets upper case, all in
/// lower case.
std::string snake_case(std::string_view camel_case);

}  // namespace aureole
