// SPDX-License-Identifier: Apache-2.0
// `FileText`: the bytes of a file with errors that name it, and a scanner for numbers in text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "aureole/core/error.h"

namespace aureole {

/// A file in memory or mapped. Derived classes hold the bytes and define the location of its errors.
class FileText {
public:
  virtual ~FileText() = default;

  const char* begin() const { return begin_; }
  const char* end() const { return end_; }
  std::size_t size() const { return std::size_t(end_ - begin_); }

  /// Returns an Error that names the file.
  [[nodiscard]] virtual Error error(const std::string& message) const = 0;
  /// Returns an Error that names the file and the line that contains `at`.
  [[nodiscard]] virtual Error error_at(const char* at, const std::string& message) const;

protected:
  void set_bytes(const char* begin, const char* end) { begin_ = begin, end_ = end; }
  /// Returns the line that contains `at`, counted from 1.
  std::size_t line_of(const char* at) const;

private:
  const char *begin_ = nullptr, *end_ = nullptr;
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
  /// Returns the next word; empty at the end.
  std::string_view word();
  /// Returns the remaining text of the line, without blanks around it.
  std::string_view rest();
  /// Reads a number. If there is none it returns false and consumes only blanks. Infinities and NaN are
  /// numbers here.
  bool number(double& value);
  bool integer(long long& value);
};

}  // namespace aureole
