// SPDX-License-Identifier: Apache-2.0
// `MeshFile`: the file of a mesh in memory, with errors located at the parameter that names it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "aureole/parameter/ply/file_text.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// A mesh file in memory, from the parameter `filename`. A zero byte follows its last byte.
class MeshFile final : public FileText {
public:
  /// Reads the whole file; throws Error located at `filename`.
  explicit MeshFile(const Properties& properties) : MeshFile(properties, properties.get_file("filename")) {}
  /// Reads a file that the mesh file refers to; throws Error located at `filename`.
  MeshFile(const Properties& properties, std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }

  using FileText::begin;
  char* begin() { return bytes_.get(); }

  /// Returns an Error located at the parameter `filename` that also names the file.
  [[nodiscard]] Error error(const std::string& message) const override;

private:
  const Properties& properties_;
  std::filesystem::path path_;
  std::unique_ptr<char[]> bytes_;
};

}  // namespace aureole
