// SPDX-License-Identifier: Apache-2.0
// Sorts the messages of a scene by location.
#pragma once

#include <string>
#include <vector>

#include "aureole/loading/node.h"

namespace aureole {

/// Sorts messages "file:line:column: text" by location; an included file counts at its <include>. Messages
/// about included files are extended by the location of the <include>. Messages without a location come last.
std::vector<std::string> in_file_order(const std::vector<std::string>& messages,
                                       const std::vector<SourceFilePtr>& files);

}  // namespace aureole
