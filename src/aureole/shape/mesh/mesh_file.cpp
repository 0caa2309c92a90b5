// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh_file.h"

#include <algorithm>
#include <charconv>

#include "aureole/core/input_file.h"

namespace aureole {

MeshFile::MeshFile(const Properties& properties, std::filesystem::path path)
    : properties_(properties), path_(std::move(path)) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 38;
  try {
    InputFile file(path_);
    file.require_at_most(kMaxBytes);
    size_ = std::size_t(file.size());
    bytes_ = std::make_unique_for_overwrite<char[]>(size_ + 1);
    file.read(bytes_.get(), size_);
    bytes_[size_] = 0;
  } catch (const Error& problem) {
    throw error(problem.message());
  }
  // The byte order mark of a text becomes blanks, which keeps columns and the place of data.
  if (std::string_view(bytes_.get(), size_).starts_with("\xEF\xBB\xBF")) std::fill_n(bytes_.get(), 3, ' ');
}

Error MeshFile::error(const std::string& message) const {
  return properties_.error("filename", "\"" + path_.string() + "\": " + message);
}

Error MeshFile::error_at(const char* at, const std::string& message) const {
  const auto line = 1 + std::count(begin(), std::min(at, end()), '\n');
  return error("line " + std::to_string(line) + ": " + message);
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
    // from_chars leaves the value unchanged. A number too small becomes zero; one too large becomes infinite,
    // and its triangles are dropped.
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
