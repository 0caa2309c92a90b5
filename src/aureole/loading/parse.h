// SPDX-License-Identifier: Apache-2.0
// First stage of loading: XML text -> nodes. Expands <include>, <default> and $name, and collects <path>.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/loading/node.h"

namespace aureole {

struct ParsedScene {
  Node root;  ///< element <scene>, without <include>, <default> and <path>
  std::vector<std::filesystem::path> search_folders;  ///< folders of <path>, absolute, in reverse order
  std::vector<SourceFilePtr> files;                   ///< files that were read, the main file first
  bool complete = true;  ///< false if a part could not be read, which has been reported
};

/// Parses `file`, or `text` as if it were the content of `file`. Problems are added to `diagnostics`;
/// everything that could be read is returned.
ParsedScene parse_scene(const std::filesystem::path& file, const std::optional<std::string>& text,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Diagnostics& diagnostics);

/// Finds the file `filename` that is written in `from`: beside that file, beside the files that include it,
/// or in one of `folders`. Returns an empty path if it is not found.
std::filesystem::path find_file(const std::string& filename, const SourceFile& from,
                                const std::vector<std::filesystem::path>& folders);

}  // namespace aureole
