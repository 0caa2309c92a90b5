// SPDX-License-Identifier: Apache-2.0
// Sorts the messages of a scene by location.
#pragma once

#include <string>
#include <vector>

#include "aureole/loading/node.h"

namespace aureole {

/// Sorts "file:line:column: text" messages by place, an included file at the place of its <include>, and
/// appends to messages about included files where they are included. Messages without a place come last.
std::vector<std::string> in_file_order(const std::vector<std::string>& messages,
                                       const std::vector<SourceFilePtr>& files);

}  // namespace aureole
