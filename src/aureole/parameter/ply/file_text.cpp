// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/ply/file_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace aureole {

std::size_t FileText::line_of(const char* at) const {
  return std::size_t(1 + std::count(begin(), std::min(at, end()), '\n'));
}

Error FileText::error_at(const char* at, const std::string& message) const {
  return error("line " + std::to_string(line_of(at)) + ": " + message);
}

std::string_view Scanner::word() {
  skip_blanks();
  const char* start = at;
  while (at < end && *at != ' ' && *at != '\t' && *at != '\r' && *at != '\n') ++at;
  return {start, std::size_t(at - start)};
}

std::string_view Scanner::rest() {
  skip_blanks();
  const char* last = end;
  while (last > at && (last[-1] == ' ' || last[-1] == '\t' || last[-1] == '\r' || last[-1] == '\n')) --last;
  const std::string_view text(at, std::size_t(last - at));
  at = end;
  return text;
}

bool Scanner::number(double& value) {
  skip_blanks();
  const char* start = at < end && *at == '+' ? at + 1 : at;
  const auto [next, code] = std::from_chars(start, end, value);
  if (code == std::errc::result_out_of_range) {
    // std::from_chars leaves the value unchanged for a number out of range. A number too small becomes zero;
    // one too large becomes infinite, and its triangles are dropped.
    const bool small =
        std::string_view(start, std::size_t(next - start)).find("e-") != std::string_view::npos ||
        std::string_view(start, std::size_t(next - start)).find("E-") != std::string_view::npos;
    value = small ? 0 : HUGE_VAL;
  } else if (code != std::errc()) {
    return false;
  }
  at = next;
  return true;
}

bool Scanner::integer(long long& value) {
  skip_blanks();
  const char* start = at < end && *at == '+' ? at + 1 : at;
  const auto [next, code] = std::from_chars(start, end, value);
  if (code != std::errc()) return false;
  at = next;
  return true;
}

}  // namespace aureole
