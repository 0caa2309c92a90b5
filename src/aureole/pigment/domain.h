// SPDX-License-Identifier: Apache-2.0
// Errors of the functions in this folder for arguments out of range.
#pragma once

#include <charconv>
#include <stdexcept>
#include <string>

namespace aureole::pigment {

/// A number as text, with at most six significant digits.
inline std::string number_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6);
  return {text, end.ptr};
}

/// Throws std::domain_error "<name> <rule>, got <value>" unless `ok`.
inline void require(bool ok, double value, const std::string& name, const char* rule) {
  if (!ok) throw std::domain_error(name + " " + rule + ", got " + number_text(value));
}
/// Throws like the function above. It makes a string of the name only for an error, since innermost loops
/// check their arguments.
inline void require(bool ok, double value, const char* name, const char* rule) {
  if (!ok) require(false, value, std::string(name), rule);
}
inline void require_fraction(double value, const char* name) {
  require(value >= 0 && value <= 1, value, name, "must be in [0, 1]");
}
inline void require_not_negative(double value, const char* name) {
  require(value >= 0, value, name, "must not be negative");
}

}  // namespace aureole::pigment
