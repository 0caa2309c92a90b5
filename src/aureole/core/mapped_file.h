// SPDX-License-Identifier: Apache-2.0
// `MappedFile`: the bytes of a user's file, mapped into memory without a copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <span>

#include "aureole/core/error.h"

namespace aureole {

/// Bytes together with their owner, which keeps them alive: a mapped file, or memory.
struct SharedBytes {
  std::span<const std::byte> bytes;
  std::shared_ptr<const void> owner;

  std::size_t size() const { return bytes.size(); }
  /// Returns the bytes from `first` on. `first` must not exceed the size.
  SharedBytes from(std::size_t first) const { return {bytes.subspan(first), owner}; }
};

/// A regular file mapped into memory for reading: opening takes no time that grows with the file, and pages are
/// read when they are first used. All errors are located at the file. As with every mapped file, a file that
/// another program shortens meanwhile ends this program (SIGBUS). Implemented in input_file.cpp, which opens files.
class MappedFile {
public:
  /// Maps a file. Throws Error if there is no regular file that can be opened. Never blocks.
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Returns the bytes of a regular file, mapped. Throws Error as MappedFile does.
SharedBytes map_file(const std::filesystem::path& file);

/// Maps a file and returns `read(bytes)`. Errors that `read` throws without a file, and failed allocations,
/// are located at this file.
template <class Read>
auto read_mapped(const std::filesystem::path& file, const Read& read) {
  const SharedBytes bytes = map_file(file);
  try {
    return read(bytes);
  } catch (const std::bad_alloc&) {
    throw Error({file.string(), 0, 0}, "needs more memory than there is");
  } catch (const Error& problem) {
    if (!problem.where().file.empty()) throw;
    throw Error({file.string(), problem.where().line, 0}, problem.message());
  }
}

}  // namespace aureole
