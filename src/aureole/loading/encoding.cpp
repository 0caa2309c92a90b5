// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/encoding.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "aureole/core/letter_case.h"

namespace aureole {

namespace {

using namespace std::string_view_literals;

void append(std::string& out, std::uint32_t c) {
  // invalid code points become the replacement character
  if (c > 0x10ffff || (c >= 0xd800 && c < 0xe000)) c = 0xfffd;
  if (c < 0x80) {
    out += char(c);
  } else if (c < 0x800) {
    out += {char(0xc0 | c >> 6), char(0x80 | (c & 63))};
  } else if (c < 0x10000) {
    out += {char(0xe0 | c >> 12), char(0x80 | (c >> 6 & 63)), char(0x80 | (c & 63))};
  } else {
    out += {char(0xf0 | c >> 18), char(0x80 | (c >> 12 & 63)), char(0x80 | (c >> 6 & 63)),
            char(0x80 | (c & 63))};
  }
}

/// Decodes units of 2 or 4 bytes. An incomplete unit at the end is ignored.
std::string from_wide(std::string_view text, std::size_t bytes, bool big_endian) {
  std::string out;
  std::uint32_t high = 0;  // first half of a UTF-16 surrogate pair
  for (std::size_t at = 0; at + bytes <= text.size(); at += bytes) {
    std::uint32_t c = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      c = c << 8 | static_cast<unsigned char>(text[at + (big_endian ? i : bytes - 1 - i)]);
    if (high) {
      const bool pairs = c >= 0xdc00 && c < 0xe000;
      append(out, pairs ? 0x10000 + ((high - 0xd800) << 10) + (c - 0xdc00) : 0xfffd);
      high = 0;
      if (pairs) continue;
    }
    if (bytes == 2 && c >= 0xd800 && c < 0xdc00)
      high = c;
    else if (c != 0xfeff || at > 0)
      append(out, c);
  }
  return out;
}

/// Whether the XML declaration contains encoding="iso-8859-1" or latin1.
bool declares_latin1(std::string_view text) {
  if (!text.starts_with("<?xml")) return false;
  const std::string declaration = lower_case(text.substr(0, text.find("?>")));
  const std::size_t at = declaration.find("encoding");
  if (at == std::string::npos) return false;
  return declaration.find("iso-8859-1", at) != std::string::npos ||
         declaration.find("latin1", at) != std::string::npos;
}

}  // namespace

std::string to_utf8(std::string text) {
  const std::string_view t = text;
  // UTF-32 is tested first: its little-endian byte order mark begins with the mark of UTF-16.
  if (t.starts_with("\xff\xfe\0\0"sv) || t.starts_with("<\0\0\0"sv)) return from_wide(t, 4, false);
  if (t.starts_with("\0\0\xfe\xff"sv) || t.starts_with("\0\0\0<"sv)) return from_wide(t, 4, true);
  if (t.starts_with("\xff\xfe"sv) || t.starts_with("<\0"sv)) return from_wide(t, 2, false);
  if (t.starts_with("\xfe\xff"sv) || t.starts_with("\0<"sv)) return from_wide(t, 2, true);
  if (t.starts_with("\xef\xbb\xbf"sv)) return text.substr(3);
  if (!declares_latin1(t)) return text;
  std::string out;
  for (const char c : t) append(out, static_cast<unsigned char>(c));
  return out;
}

}  // namespace aureole
