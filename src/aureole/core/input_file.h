// SPDX-License-Identifier: Apache-2.0
// `InputFile`: the one way to open a file of the user. Only regular files are opened: a pipe would block until
// somebody writes to it, and a device may be endless.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>

namespace aureole {

/// Returns why a path cannot be read as a file: "no such file", "not a regular file but a pipe", "cannot be
/// opened: Permission denied"; empty if it can be. Never blocks. For libraries that open files themselves.
std::string fault_of_input(const std::filesystem::path& file);

/// Returns what is at a path if it is no regular file: "a folder", "a pipe", "a device", "a socket". Empty for
/// a regular file and where there is nothing. Symbolic links are followed.
std::string irregular_kind(const std::filesystem::path& file);

/// A regular file opened for reading. All errors are located at the file.
class InputFile {
public:
  /// Opens a file. Throws Error if there is no regular file that can be opened. Never blocks.
  explicit InputFile(std::filesystem::path file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Size in bytes when the file was opened. Bytes appended later are not read.
  std::uint64_t size() const { return size_; }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return size_ - position_; }

  /// Reads the next `bytes` bytes. Throws Error if there are fewer.
  void read(void* to, std::uint64_t bytes);
  /// Moves the position forwards. Throws Error if there are fewer bytes.
  void skip(std::uint64_t bytes);

  /// Throws Error if the file has more than `max_bytes` bytes, or more than the available memory. Call it
  /// before memory for the content is allocated.
  void require_at_most(std::uint64_t max_bytes) const;

private:
  void require_left(std::uint64_t bytes) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0, position_ = 0;
};

/// Upper bounds of text files. Parsed text takes up to 60 times the memory of the file: a scene may list a million
/// objects, tables of measurements are small.
constexpr std::uint64_t kMaxSceneBytes = std::uint64_t(1) << 28, kMaxTableBytes = std::uint64_t(1) << 25,
                        kMaxJsonBytes = std::uint64_t(1) << 24;

/// Returns the content of a regular file. Throws Error located at the file, also for more than `max_bytes`.
std::string read_text_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Returns the content of a table of measurements as a stream. Throws Error located at the file.
std::istringstream read_table_file(const std::filesystem::path& file);

}  // namespace aureole
