// SPDX-License-Identifier: Apache-2.0
// Utilities of the mesh readers: a file in memory, a scanner for numbers in text, errors that name the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"

namespace aureole {

/// A mesh file in memory, from the parameter `filename`. A zero byte follows its last byte.
class MeshFile {
public:
  /// Reads the whole file; throws Error located at `filename`.
  explicit MeshFile(const Properties& properties) : MeshFile(properties, properties.get_file("filename")) {}
  /// Reads a file that the mesh file refers to; throws Error located at `filename`.
  MeshFile(const Properties& properties, std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }

  const char* begin() const { return bytes_.get(); }
  char* begin() { return bytes_.get(); }
  const char* end() const { return bytes_.get() + size_; }
  std::size_t size() const { return size_; }

  /// Returns an Error located at the parameter `filename` that also names the file.
  [[nodiscard]] Error error(const std::string& message) const;
  /// Returns such an Error that also gives the line of the file that contains `at`.
  [[nodiscard]] Error error_at(const char* at, const std::string& message) const;

private:
  const Properties& properties_;
  std::filesystem::path path_;
  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
};

/// Reads numbers and words between blanks from [at, end).
struct Scanner {
  const char* at;
  const char* end;

  void skip_blanks() {
    while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  }
  void skip_white() {
    while (at < end && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n')) ++at;
  }
  bool at_end() {
    skip_blanks();
    return at >= end;
  }
  /// Returns the next word, empty at the end.
  std::string_view word();
  /// Returns what is left, without blanks around it.
  std::string_view rest();
  /// Reads a number. If there is none it returns false and consumes only blanks. Infinities and NaN are
  /// numbers here.
  bool number(double& value);
  bool integer(long long& value);
};

}  // namespace aureole
