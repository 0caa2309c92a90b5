// SPDX-License-Identifier: Apache-2.0
// The container of RGL's material database: named arrays of numbers in one binary file (`tensor_file`, version 1.0).
// Layout, little-endian: the 12 bytes "tensor_file\0", two bytes of the version, the number of fields (uint32); for
// each field the length of its name (uint16), the name, the number of axes (uint16), the type (uint8), the position
// of its numbers from the start of the file (uint64) and the length of each axis (uint64); then the numbers, the
// last axis fastest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/mapped_file.h"

namespace aureole {

/// The type of a field's numbers, by its code in the file.
enum class TensorType : std::uint8_t {
  uint8 = 1,
  int8,
  uint16,
  int16,
  uint32,
  int32,
  uint64,
  int64,
  float16,
  float32,
  float64
};

/// An array in a tensor file. Its numbers lie within the file, at any alignment.
struct TensorField {
  std::string name;
  TensorType type = TensorType::float32;
  std::vector<std::size_t> shape;
  std::span<const std::byte> bytes;

  std::size_t count() const;  ///< Returns the number of numbers in the array.
};

/// Returns "8 x 32 x 32", for messages.
std::string shape_text(std::span<const std::size_t> shape);

/// A tensor file that was opened for reading; the numbers stay in the mapped file until they are read.
class TensorFile {
public:
  /// Throws Error located at the file if it is no tensor file, is truncated, or has fields that overrun it.
  explicit TensorFile(const std::filesystem::path& file);

  const TensorField* find(std::string_view name) const;
  /// Returns the field of that name. Throws Error that lists the fields of the file if there is none.
  const TensorField& field(std::string_view name) const;
  /// Returns the numbers of a field of floats (32 or 64 bits). Throws Error for another type, for another number of
  /// axes than `axes`, and for numbers that are not finite.
  std::vector<float> floats(std::string_view name, std::size_t axes) const;
  /// Returns the bytes of a field of uint8 with one axis as text. Throws Error for another type.
  std::string text(std::string_view name) const;
  /// Returns an Error located at the file.
  Error error(const std::string& message) const;

private:
  std::filesystem::path file_;
  SharedBytes content_;
  std::vector<TensorField> fields_;
};

/// Builds the bytes of a tensor file.
class TensorFileWriter {
public:
  void add(std::string name, std::vector<std::size_t> shape, std::span<const float> numbers);
  void add_bytes(std::string name, std::string_view bytes);
  /// The content of the file; every array begins at a multiple of 8 bytes.
  std::string content() const;

private:
  struct Entry {
    std::string name;
    TensorType type;
    std::vector<std::size_t> shape;
    std::string bytes;
  };
  std::vector<Entry> entries_;
};

}  // namespace aureole
