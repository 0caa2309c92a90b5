// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: its elements, their properties and types.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aureole/parameter/ply/file_text.h"

namespace aureole::ply {

enum class Type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

constexpr std::size_t size_of(Type t) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[int(t)];
}

struct Property {
  std::string name;
  Type type = Type::float32;
  bool is_list = false;
  Type count_type = Type::uint8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  /// Returns the index of a property, or -1.
  int find(std::string_view property) const;
  bool has_lists() const;
  /// Returns the number of bytes of one record with empty lists.
  std::size_t least_bytes() const;
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  const char* body = nullptr;  ///< the first byte after the header
};

/// Reads the header. Throws an Error that names the line.
Header read_header(const FileText& file);

}  // namespace aureole::ply
