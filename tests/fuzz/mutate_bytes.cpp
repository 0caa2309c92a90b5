// SPDX-License-Identifier: Apache-2.0
#include "fuzz/mutate_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "fuzz/scene_values.h"

namespace aureole::fuzz {

namespace {

/// A place, more often near the start, where headers are.
std::size_t place(const std::string& s, Random& random) {
  const std::size_t size = s.size() + 1;
  return random.chance(0.5) ? random.below(std::min<std::size_t>(size, 128)) : random.below(size);
}

void overwrite(std::string& s, std::size_t at, std::uint64_t value, std::size_t bytes, bool big_endian) {
  for (std::size_t i = 0; i < bytes && at + i < s.size(); ++i)
    s[at + i] = char(value >> 8 * (big_endian ? bytes - 1 - i : i));
}

void mutate_bytes(std::string& s, Random& random) {
  static constexpr std::uint64_t kNumbers[] = {0,
                                               1,
                                               2,
                                               3,
                                               0x7f,
                                               0x80,
                                               0xff,
                                               0x100,
                                               0x7fff,
                                               0x8000,
                                               0xffff,
                                               0x10000,
                                               0x7fffffff,
                                               0x80000000,
                                               0xffffffff,
                                               0x100000000,
                                               0x7f800000,
                                               0xff800000,
                                               0x7fc00000,
                                               0x7f7fffff,
                                               0x00000001,
                                               0xfffffffe,
                                               0x7fffffffffffffff,
                                               0x8000000000000000,
                                               0xffffffffffffffff,
                                               0x7ff0000000000000,
                                               0x3fffffff,
                                               0x40000000};
  if (s.empty()) s = "\n";
  const std::size_t at = std::min(place(s, random), s.size() - 1);
  const std::size_t length = std::min(random.few(12) * random.few(12), s.size() - at);
  switch (random.below(10)) {
    case 0:
    case 1:
      s[at] = char(s[at] ^ (1 << random.below(8)));
      break;
    case 2:
      s[at] = char(random.bits());
      break;
    case 3:
    case 4:
    case 5:
      overwrite(s, at, random.pick(kNumbers), std::size_t(1) << random.below(4), random.chance(0.5));
      break;
    case 6:
      s.resize(random.chance(0.5) ? at : random.below(s.size() + 1));
      break;
    case 7:
      s.erase(at, length);
      break;
    case 8:
      s.insert(at, s.substr(random.below(s.size()), length));
      break;
    default:
      for (std::size_t i = 0; i < length; ++i) s[at + i] = char(random.chance(0.5) ? 0xff : 0);
  }
}

/// Begin and end of the words of a text; a word is a number, a name or a single other character.
std::vector<std::pair<std::size_t, std::size_t>> words_of(const std::string& s, std::size_t end) {
  std::vector<std::pair<std::size_t, std::size_t>> words;
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_.+-", c);
  };
  for (std::size_t i = 0; i < end;) {
    const std::size_t begin = i;
    while (i < end && s[i] != 0 && is_word(s[i])) ++i;
    if (i == begin) ++i;
    if (!std::isspace(static_cast<unsigned char>(s[begin]))) words.emplace_back(begin, i);
  }
  return words;
}

/// Only the first `end` bytes are taken for text: a header, or everything.
void mutate_words(std::string& s, std::size_t end, Random& random) {
  const auto words = words_of(s, std::min(end, s.size()));
  if (words.empty()) return;
  const auto [a, a_end] = random.pick(words);
  const auto [b, b_end] = random.pick(words);
  const std::string word_b = s.substr(b, b_end - b);
  switch (random.below(5)) {
    case 0:
      s.replace(a, a_end - a, word_b);
      break;
    case 1:
      s.erase(a, a_end - a);
      break;
    case 2:
      s.insert(a, word_b + " ");
      break;
    default:
      s.replace(a, a_end - a, changed_value(s.substr(a, a_end - a), random));
  }
}

void mutate_lines(std::string& s, Random& random) {
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 0; i + 1 < s.size(); ++i)
    if (s[i] == '\n') starts.push_back(i + 1);
  const auto line = [&](std::size_t start) { return s.substr(start, s.find('\n', start) - start + 1); };
  const std::size_t a = random.pick(starts), b = random.pick(starts);
  const std::string line_a = line(a), line_b = line(b);
  switch (random.below(4)) {
    case 0:
      s.erase(a, line_a.size());
      break;
    case 1:
      s.insert(a, line_b);
      break;
    case 2:
      s.replace(a, line_a.size(), line_b);
      break;
    default:
      s.resize(a);
  }
}

/// UTF-16 and UTF-32 of what is ASCII.
std::string widened(const std::string& s, std::size_t bytes, bool big_endian) {
  std::string out(bytes, 0);
  overwrite(out, 0, 0xfeff, bytes, big_endian);
  for (const char c : s) {
    out.resize(out.size() + bytes);
    overwrite(out, out.size() - bytes, static_cast<unsigned char>(c), bytes, big_endian);
  }
  return out;
}

bool is_text(const std::string& s) {
  return std::all_of(s.begin(), s.end(),
                     [](char c) { return c == '\n' || c == '\r' || c == '\t' || c >= ' '; });
}

/// Chunks of a PNG get the checksums of their content.
void repair_png(std::string& s) {
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<unsigned char>(s[at + i]);
    return v;
  };
  for (std::size_t at = 8; at + 12 <= s.size();) {
    const std::size_t length = number(at);
    if (length > s.size() - at - 12) return;
    const auto* chunk = reinterpret_cast<const Bytef*>(s.data()) + at + 4;
    overwrite(s, at + 8 + length, crc32(0, chunk, uInt(length) + 4), 4, true);
    at += length + 12;
  }
}

std::string deflated(const std::string& s) {
  uLongf size = compressBound(s.size());
  std::string out(size, 0);
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(s.data()), s.size());
  out.resize(size);
  return out;
}

/// Inflates the zlib stream at `offset`; `end` is the offset behind it.
std::string inflated(const std::string& s, std::size_t offset, std::size_t& end) {
  std::string out(1 << 20, 0);
  z_stream z{};
  inflateInit(&z);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(s.data())) + offset;
  z.avail_in = uInt(s.size() - offset);
  z.next_out = reinterpret_cast<Bytef*>(out.data()), z.avail_out = uInt(out.size());
  inflate(&z, Z_FINISH);
  end = s.size() - z.avail_in;
  out.resize(z.total_out);
  inflateEnd(&z);
  return out;
}

/// The first mesh of a .serialized file, changed inside its compressed stream.
void mutate_serialized(std::string& s, Random& random) {
  std::size_t end = 0;
  std::string inside = inflated(s, 4, end);
  mutate_bytes(inside, random);
  s.replace(4, end - 4, deflated(inside));
}

void mutate_once(std::string& s, Random& random) {
  if (s.size() > 8 && s.starts_with("\x1c\x04") && random.chance(0.7)) return mutate_serialized(s, random);
  if (s.starts_with("ply") && random.chance(0.6)) {
    const std::size_t header = s.find("end_header");
    return mutate_words(s, header == std::string::npos ? s.size() : header + 10, random);
  }
  if (is_text(s) && random.chance(0.8))
    return random.chance(0.7) ? mutate_words(s, s.size(), random) : mutate_lines(s, random);
  mutate_bytes(s, random);
}

}  // namespace

std::string mutate_text(std::string s, Random& random) {
  for (std::size_t i = random.few(5); i > 0; --i) {
    if (random.chance(0.02))
      s = widened(s, random.chance(0.5) ? 2 : 4, random.chance(0.5));
    else if (random.chance(0.4))
      mutate_words(s, s.size(), random);
    else if (random.chance(0.5))
      mutate_lines(s, random);
    else
      mutate_bytes(s, random);
  }
  return s;
}

std::string mutate_data(const std::string& bytes, Random& random) {
  std::string s = bytes;
  for (std::size_t i = random.few(6); i > 0; --i) mutate_once(s, random);
  if (s.starts_with("\x89PNG") && random.chance(0.8)) repair_png(s);
  return s;
}

}  // namespace aureole::fuzz
