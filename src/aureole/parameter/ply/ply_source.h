// SPDX-License-Identifier: Apache-2.0
// Reads the body of a PLY file as a sequence of values, in text or in binary of either byte order.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>

#include "aureole/parameter/ply/ply_header.h"

namespace aureole::ply {

/// Reads values from a text body, one after the other.
class TextSource {
public:
  TextSource(const FileText& file, const char* at) : file_(file), s_{at, file.end()} {}
  double value(Type) {
    double v;
    s_.skip_white();
    if (s_.at >= s_.end) throw file_.error("the file is truncated");
    if (!s_.number(v)) throw file_.error_at(s_.at, "expected a number");
    return v;
  }
  /// Upper bound of the number of values that are left: a value takes at least a digit and a blank.
  std::size_t values_left() const { return std::size_t(s_.end - s_.at) / 2 + 1; }
  void require(std::size_t) {}
  /// Skips the rest of the record's line, which belongs to no property.
  void end_record() {
    s_.skip_blanks();
    if (s_.at >= s_.end || *s_.at == '\n') return;
    ++long_lines_;
    while (s_.at < s_.end && *s_.at != '\n') ++s_.at;
  }
  std::size_t long_lines() const { return long_lines_; }
  bool finished() {
    s_.skip_white();
    return s_.at >= s_.end;
  }

private:
  const FileText& file_;
  Scanner s_;
  std::size_t long_lines_ = 0;
};

template <bool kSwap>
class BinarySource {
public:
  BinarySource(const FileText& file, const char* at) : file_(file), at_(at), end_(file.end()) {}
  double value(Type t) {
    switch (t) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::int64:
        return double(take<std::int64_t>());
      case Type::uint64:
        return double(take<std::uint64_t>());
      case Type::float32:
        return take<float>();
      case Type::float64:
        return take<double>();
    }
    return 0;
  }
  std::size_t values_left() const { return std::size_t(end_ - at_); }
  /// Throws unless `bytes` more bytes are available, so that reading them needs no further checks.
  void require(std::size_t bytes) {
    if (std::size_t(end_ - at_) < bytes) throw file_.error("the file is truncated");
  }
  void end_record() {}
  std::size_t long_lines() const { return 0; }
  bool finished() const { return at_ == end_; }

private:
  template <class T>
  T take() {
    char raw[sizeof(T)];
    std::memcpy(raw, at_, sizeof(T));
    if constexpr (kSwap) std::reverse(raw, raw + sizeof(T));
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }

  const FileText& file_;
  const char *at_, *end_;
};

}  // namespace aureole::ply
