// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/json_place.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

namespace aureole {
namespace {

/// The mark of byte order that may stand at the beginning of a text, in UTF-8.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Steps through a JSON text that is known to be well-formed; at the end of the text all steps stay there.
class JsonScanner {
public:
  explicit JsonScanner(std::string_view text) : text_(text) {}

  std::size_t offset() const { return at_; }
  void go_to(std::size_t offset) { at_ = offset; }
  char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() {
    if (at_ == 0 && text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  void skip_character() { at_ = std::min(at_ + 1, text_.size()); }

  /// Skips a string and returns it with its quotes.
  std::string_view skip_string() {
    const std::size_t begin = at_;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    at_ = std::min(at_ + 1, text_.size());
    return text_.substr(begin, at_ - begin);
  }

  /// Skips a value of any kind. Nested containers are counted, so that the depth of the text does not matter.
  void skip_value() {
    std::size_t depth = 0;
    do {
      skip_blanks();
      const char c = next();
      if (c == '"') {
        skip_string();
      } else if (c == '{' || c == '[') {
        ++depth, skip_character();
      } else if (c == '}' || c == ']') {
        --depth, skip_character();
      } else if (c == ',' || c == ':') {
        skip_character();
      } else {
        at_ = std::min(text_.find_first_of(",:]} \t\r\n", at_), text_.size());
      }
    } while (depth > 0 && at_ < text_.size());
  }

private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// The offset of a part of the value at which the scanner stands, or nothing if the value has no such part.
std::optional<std::size_t> part_of(JsonScanner scan, const JsonStep& step) {
  const bool is_object = scan.next() == '{';
  if ((!is_object && scan.next() != '[') || is_object != std::holds_alternative<std::string>(step)) return {};
  scan.skip_character();
  std::optional<std::size_t> found;
  for (std::size_t index = 0;; ++index) {
    scan.skip_blanks();
    if (scan.next() == '}' || scan.next() == ']' || scan.next() == '\0') return found;
    bool is_wanted = !is_object && index == std::get<std::size_t>(step);
    if (is_object) {
      const std::string_view key = scan.skip_string();
      scan.skip_blanks(), scan.skip_character(), scan.skip_blanks();
      // Of members with one key the parser keeps the last.
      is_wanted = nlohmann::json::parse(key).get<std::string>() == std::get<std::string>(step);
    }
    if (is_wanted) found = scan.offset();
    if (is_wanted && !is_object) return found;
    scan.skip_value(), scan.skip_blanks();
    if (scan.next() == ',') scan.skip_character();
  }
}

}  // namespace

std::string json_path_text(const JsonPath& path) {
  std::string text;
  for (const JsonStep& step : path)
    if (const auto* key = std::get_if<std::string>(&step))
      text += (text.empty() ? "" : ".") + *key;
    else
      text += "[" + std::to_string(std::get<std::size_t>(step)) + "]";
  return text;
}

SourceLocation place_of_byte(const std::string& file, std::string_view text, std::size_t offset) {
  if (text.starts_with(kByteOrderMark) && offset >= kByteOrderMark.size())
    text.remove_prefix(kByteOrderMark.size()), offset -= kByteOrderMark.size();
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t begin = before.rfind('\n') + 1;  // 0 without a line end, since npos + 1 is 0
  const auto is_first_byte = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  const std::string_view line = before.substr(begin);
  return {file, int(std::count(before.begin(), before.end(), '\n')) + 1,
          int(std::count_if(line.begin(), line.end(), is_first_byte)) + 1};
}

SourceLocation json_place(const std::string& file, std::string_view text, const JsonPath& path) {
  JsonScanner scan(text);
  scan.skip_blanks();
  for (const JsonStep& step : path) {
    const auto part = part_of(scan, step);
    if (!part) break;
    scan.go_to(*part);
  }
  return place_of_byte(file, text, scan.offset());
}

}  // namespace aureole
