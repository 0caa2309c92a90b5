// SPDX-License-Identifier: Apache-2.0
// A folder of results that is created completely or not at all: files are written to a folder beside it,
// which replaces it at the end.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "aureole/core/output_file.h"

namespace aureole {

class OutputFolder {
public:
  /// Prepares a folder of results. `marker` is a file that every result of this kind contains. An existing
  /// folder that is not empty is replaced only if it contains one. Throws Error.
  OutputFolder(std::filesystem::path folder, const std::string& marker);
  /// Temporary path of a file before the commit.
  std::filesystem::path path(const std::string& name) const { return part_->path() / name; }
  void write(const std::string& name, const std::string& text) const;
  void commit();

private:
  std::filesystem::path folder_;
  std::optional<PartFolder> part_;  ///< temporary folder; removed if it was not committed
};

}  // namespace aureole
