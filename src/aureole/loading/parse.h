// SPDX-License-Identifier: Apache-2.0
// First stage of loading: XML text -> nodes. Expands <include>, <default> and $name and takes in <path>.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/loading/node.h"

namespace aureole {

struct ParsedScene {
  Node root;                                          ///< <scene>, without <include>, <default> and <path>
  std::vector<std::filesystem::path> search_folders;  ///< of <path>, absolute, the last written first
  std::vector<SourceFilePtr> files;                   ///< the main file first
  bool complete = true;                               ///< false where a part could not be read (reported)
};

/// Reads `file`, or `text` as if it were the content of `file`. Problems go to `diagnostics`; what could be
/// read is returned.
ParsedScene parse_scene(const std::filesystem::path& file, const std::optional<std::string>& text,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Diagnostics& diagnostics);

/// Where `filename`, written in `from`, lies: beside that file, beside the files that include it, or in one
/// of `folders`. An empty path if nowhere.
std::filesystem::path find_file(const std::string& filename, const SourceFile& from,
                                const std::vector<std::filesystem::path>& folders);

}  // namespace aureole
