// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh_file.h"

#include <algorithm>

#include "aureole/core/input_file.h"

namespace aureole {

MeshFile::MeshFile(const Properties& properties, std::filesystem::path path)
    : properties_(properties), path_(std::move(path)) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 38;
  try {
    InputFile file(path_);
    file.require_at_most(kMaxBytes);
    const std::size_t size = std::size_t(file.size());
    bytes_ = std::make_unique_for_overwrite<char[]>(size + 1);
    file.read(bytes_.get(), size);
    bytes_[size] = 0;
    set_bytes(bytes_.get(), bytes_.get() + size);
  } catch (const Error& problem) {
    throw error(problem.message());
  }
  // A byte order mark becomes blanks, so that columns and positions in the file do not change.
  if (std::string_view(begin(), size()).starts_with("\xEF\xBB\xBF")) std::fill_n(bytes_.get(), 3, ' ');
}

Error MeshFile::error(const std::string& message) const {
  return properties_.error("filename", "\"" + path_.string() + "\": " + message);
}

}  // namespace aureole
