// SPDX-License-Identifier: Apache-2.0
// The messages of a scene in the order in which a reader meets their places.
#pragma once

#include <string>
#include <vector>

#include "aureole/scene/node.h"

namespace aureole {

/// Sorts "file:line:column: text" messages by place, an included file at the place of its <include>, and
/// appends to messages about included files where they are included. Messages without a place come last.
std::vector<std::string> in_file_order(const std::vector<std::string>& messages,
                                       const std::vector<SourceFilePtr>& files);

}  // namespace aureole
