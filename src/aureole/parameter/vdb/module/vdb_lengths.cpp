// SPDX-License-Identifier: Apache-2.0
#include "vdb_lengths.h"

#include <cstdint>
#include <fstream>
#include <string>

namespace aureole {
namespace {

constexpr std::int64_t kMagic = 0x56444220;
constexpr std::uint32_t kFirstVersion = 222;  // version of OpenVDB 1.0

class Reader {
public:
  explicit Reader(const char* path) : in_(path, std::ios::binary | std::ios::ate) {
    size_ = in_ ? std::int64_t(in_.tellg()) : 0;
    in_.seekg(0);
  }
  bool good() const { return good_ && in_.good(); }
  template <class T>
  T number() {
    T value{};
    in_.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
  }
  void skip(std::int64_t bytes) { go_to(std::int64_t(in_.tellg()) + bytes); }
  void skip_text() { skip(number<std::uint32_t>()); }
  /// Reads a text of at most `most` characters; longer ones are skipped.
  std::string text(std::uint32_t most) {
    const auto length = number<std::uint32_t>();
    if (length > most) return skip(length), "";
    std::string characters(length, '\0');
    in_.read(characters.data(), length);
    return characters;
  }
  void skip_metadata() {
    const auto count = number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count && good(); ++i) {
      skip_text();  // skips the name of the metadata
      const bool lists_leaves = text(64) == "__delayedload";
      const auto length = number<std::uint32_t>();
      const std::int64_t value = position();
      if (lists_leaves && length >= sizeof(std::uint32_t)) {
        // The reader allocates a number for each leaf, and each leaf has a mask of 64 bytes in the file.
        if (number<std::uint32_t>() > size_ / 64) good_ = false;
      }
      go_to(value + length);
    }
  }
  std::int64_t position() { return in_.tellg(); }
  void go_to(std::int64_t position) {
    if (position < 0 || position > size_) good_ = false;
    if (good_) in_.seekg(position);
  }

private:
  std::ifstream in_;
  std::int64_t size_ = 0;
  bool good_ = true;
};

/// Whether all lengths after the version refer to positions within the file.
bool lengths_are_good(Reader& in) {
  in.skip(2 * sizeof(std::uint32_t));  // version of the library
  const bool has_offsets = in.number<char>() != 0;
  in.skip(36);  // skips the unique identifier
  in.skip_metadata();
  const auto grids = in.number<std::int32_t>();
  for (std::int32_t i = 0; i < grids && in.good(); ++i) {
    in.skip_text();  // skips the name of the grid
    in.skip_text();  // skips its type
    in.skip_text();  // parent grid, if it is an instance
    const auto grid = in.number<std::int64_t>();
    in.skip(sizeof(std::int64_t));  // skips the position of its values
    const auto end = in.number<std::int64_t>();
    if (!has_offsets) return in.good();  // the grids follow one another without a list
    in.go_to(grid);
    in.skip(sizeof(std::uint32_t));  // skips the compression flags
    in.skip_metadata();
    in.skip_text();  // skips the type of the transform
    in.go_to(end);
  }
  return in.good();
}

}  // namespace

std::string fault_of_vdb_header(const char* path, std::uint32_t newest) {
  Reader in(path);
  if (in.number<std::int64_t>() != kMagic) return {};
  const auto version = in.number<std::uint32_t>();
  if (!in.good() || version < kFirstVersion || version > newest)
    return "is of version " + std::to_string(version) + " of its format; those from " +
           std::to_string(kFirstVersion) + " to " + std::to_string(newest) + " can be read";
  return lengths_are_good(in) ? "" : "is damaged: a length in its header leads beyond its end";
}

}  // namespace aureole
