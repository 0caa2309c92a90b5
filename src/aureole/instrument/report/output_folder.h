// SPDX-License-Identifier: Apache-2.0
// A folder of results that is there as a whole or not at all: files are written beside it and take its place
// at the end.
#pragma once

#include <filesystem>
#include <string>

namespace aureole {

class OutputFolder {
public:
  /// `marker` is a file that every result of this kind has: a folder that exists and is not empty is replaced
  /// only if it holds one. Throws Error.
  OutputFolder(std::filesystem::path folder, const std::string& marker);
  /// Removes the files if they were not committed.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a file for now.
  std::filesystem::path path(const std::string& name) const { return part_ / name; }
  void write(const std::string& name, const std::string& text) const;
  void commit();

private:
  std::filesystem::path folder_, part_;
};

}  // namespace aureole
