// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/grid/grid_reader.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <type_traits>

#include "aureole/core/memory.h"
#include "aureole/core/units.h"

namespace aureole::grid_reader {

namespace {

/// Largest ratio of content to file size: deflate compresses at most 1032 to 1; bzip2 may exceed it on
/// constant data.
constexpr double kContentPerByte = 1100;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

[[noreturn]] void truncated(const char* what, double wanted, double found) {
  throw Error(fmt::format("is truncated: {} need {:.0f} bytes, but there are {:.0f}", what, wanted, found));
}

/// Output that grows by doubling to at most `wanted` bytes, so that a header alone allocates nothing.
class GrowingBytes {
public:
  explicit GrowingBytes(std::uint64_t wanted) : wanted_(wanted) {}
  /// Makes room for more output. Returns the free bytes behind the filled ones; empty where all output is
  /// there.
  std::span<std::byte> room() {
    if (filled_ == bytes_.size())
      bytes_.resize(
          std::size_t(std::min<std::uint64_t>(wanted_, std::max<std::size_t>(2 * filled_, 1 << 16))));
    return std::span(bytes_).subspan(filled_);
  }
  void fill(std::size_t count) { filled_ += count; }
  std::vector<std::byte> take() {
    bytes_.resize(filled_);
    return std::move(bytes_);
  }

private:
  std::uint64_t wanted_;
  std::size_t filled_ = 0;
  std::vector<std::byte> bytes_;
};

constexpr std::size_t kMostAtOnce = 1 << 30;  // upper bound of a step, since both libraries count in 32 bits

/// Decompresses `source` to at most `wanted` bytes. `decode(stream)` reads from and writes to the stream of zlib or bzip2
/// and returns its status; `goes_on(status, is_stuck, read)` decides whether there is more.
template <class Stream, class Decode, class GoesOn>
SharedBytes decompressed(const SharedBytes& source, std::uint64_t wanted, Stream& stream,
                         const Decode& decode, const GoesOn& goes_on) {
  using Byte = std::remove_pointer_t<decltype(stream.next_out)>;
  GrowingBytes out(wanted);
  std::size_t read = 0;
  for (std::span<std::byte> room; !(room = out.room()).empty();) {
    const std::size_t given = std::min(source.size() - read, kMostAtOnce);
    room = room.first(std::min(room.size(), kMostAtOnce));
    stream.next_in = const_cast<Byte*>(reinterpret_cast<const Byte*>(source.bytes.data() + read));
    stream.avail_in = unsigned(given);
    stream.next_out = reinterpret_cast<Byte*>(room.data());
    stream.avail_out = unsigned(room.size());
    const int status = decode(stream);
    const std::size_t used = given - stream.avail_in, made = room.size() - stream.avail_out;
    read += used;
    out.fill(made);
    if (!goes_on(status, used == 0 && made == 0, read)) break;
  }
  return shared(out.take());
}

SharedBytes bunzip(const SharedBytes& source, std::uint64_t wanted) {
  require_content(double(wanted), double(source.size()), kContentPerByte);
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  struct End {
    bz_stream* stream;
    ~End() { BZ2_bzDecompressEnd(stream); }
  } end{&stream};
  return decompressed(
      source, wanted, stream, [](bz_stream& s) { return BZ2_bzDecompress(&s); },
      [](int status, bool is_stuck, std::size_t) {
        if (status == BZ_STREAM_END) return false;
        if (status != BZ_OK) throw Error("holds damaged data compressed by bzip2");
        return !is_stuck;  // if not stuck, the stream needs more room; else the source has ended
      });
}

template <class T>
void parse_into(std::string_view text, std::uint64_t count, std::vector<std::byte>& out, bool is_half) {
  if (is_half) throw Error("has numbers of type float16 as text, which is not supported");
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    while (at < text.size() && (is_blank(text[at]) || text[at] == ',')) ++at;
    const std::size_t begin = at;
    while (at < text.size() && !is_blank(text[at]) && text[at] != ',') ++at;
    const std::string_view word = text.substr(begin, at - begin);
    if (word.empty())
      throw Error(fmt::format("is truncated: it should have {} numbers as text and has {}", count, i));
    T value;
    if constexpr (std::is_floating_point_v<T>)
      value = T(number_of(word));
    else {
      const auto [stop, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (fault != std::errc() || stop != word.data() + word.size())
        throw Error(fmt::format("has \"{}\" where a whole number from {} to {} is expected, such as 12",
                                word.substr(0, 40), +std::numeric_limits<T>::min(),
                                +std::numeric_limits<T>::max()));
    }
    std::memcpy(&out[std::size_t(i) * sizeof(T)], &value, sizeof value);
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::vector<std::byte> unhex(std::string_view text, std::uint64_t wanted) {
  std::vector<std::byte> out;
  int high = -1;
  for (const char c : text) {
    if (is_blank(c)) continue;
    if (out.size() == wanted) break;
    const int digit = hex_digit(c);
    if (digit < 0) throw Error("has a character in its hexadecimal data that is none of 0 to 9 and a to f");
    if (high < 0)
      high = digit;
    else
      out.push_back(std::byte(16 * high + digit)), high = -1;
  }
  return out;
}

}  // namespace

SharedBytes shared(std::vector<std::byte> bytes) {
  auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return {*owner, owner};
}

SharedBytes joined(std::vector<SharedBytes> pieces) {
  if (pieces.size() == 1) return pieces[0];
  std::size_t all = 0;
  for (const SharedBytes& p : pieces) all += p.size();
  std::vector<std::byte> bytes;
  bytes.reserve(all);
  for (SharedBytes& p : pieces) {
    bytes.insert(bytes.end(), p.bytes.begin(), p.bytes.end());
    p = {};
  }
  return shared(std::move(bytes));
}

std::uint64_t count_of(const std::vector<std::int64_t>& sizes, ScalarType type) {
  constexpr std::int64_t kLongest = 1 << 20;
  double all = double(bytes_of(type));
  std::uint64_t count = 1;
  std::string text;
  for (const std::int64_t n : sizes) text += (text.empty() ? "" : " x ") + std::to_string(n);
  if (sizes.empty()) throw Error("states no sizes");
  for (const std::int64_t n : sizes) {
    if (n < 1 || n > kLongest) throw Error(fmt::format("has sizes {}; each lies in [1, {}]", text, kLongest));
    all *= double(n), count *= std::uint64_t(n);
    if (all > double(std::uint64_t(1) << 62))
      throw Error(fmt::format("is truncated: its header claims {} numbers, more than any file has", text));
  }
  return count;
}

void note_surplus(ScalarGrid& grid, const SharedBytes& source, Encoding encoding, std::int64_t byte_skip,
                  std::uint64_t count) {
  constexpr std::uint64_t kPadding = 8;  // a line end or filling bytes are no sign of wrong sizes
  const std::uint64_t used =
      std::uint64_t(std::max<std::int64_t>(byte_skip, 0)) + count * bytes_of(grid.type);
  if (encoding != Encoding::raw || byte_skip < 0 || source.size() <= used + kPadding) return;
  grid.notes.push_back(fmt::format(
      "has {} bytes more than its {} numbers of the type {} need, which are not read: are its sizes right?",
      source.size() - used, count, name_of(grid.type)));
}

SharedBytes decode(const SharedBytes& source, Encoding encoding, std::int64_t byte_skip, std::uint64_t count,
                   ScalarType type) {
  const std::uint64_t needed = count * bytes_of(type);
  if (byte_skip < -1 || byte_skip > std::int64_t(1) << 60)
    throw Error(fmt::format("has a byte skip of {}; it is -1 or more", byte_skip));
  if (byte_skip == -1 && encoding != Encoding::raw)
    throw Error("has a byte skip of -1, which is for raw data only");
  const std::uint64_t skip = std::uint64_t(std::max<std::int64_t>(byte_skip, 0));
  SharedBytes all = source;
  switch (encoding) {
    case Encoding::raw: {
      const std::uint64_t first =
          byte_skip == -1 ? source.size() - std::min<std::uint64_t>(source.size(), needed) : skip;
      if (first > source.size() || needed > source.size() - first)
        truncated("its numbers", double(needed), double(source.size()) - double(first));
      return {source.bytes.subspan(std::size_t(first), std::size_t(needed)), source.owner};
    }
    case Encoding::gzip:
      all = inflate_bytes(source, skip + needed);
      break;
    case Encoding::bzip2:
      all = bunzip(source, skip + needed);
      break;
    case Encoding::hex: {
      if (skip > source.size()) truncated("its numbers", double(needed), 0);
      all = shared(unhex(text_of(source.bytes.subspan(std::size_t(skip))), needed));
      if (all.size() < needed) truncated("its numbers", double(needed), double(all.size()));
      return all;
    }
    case Encoding::text: {
      // Bound of the count: each number except the last has a character and a blank.
      if (skip > source.size() || count > (source.size() - skip) / 2 + 1)
        throw Error(
            fmt::format("is truncated: {} numbers as text do not fit into {} bytes", count, source.size()));
      std::vector<std::byte> out{std::size_t(needed)};
      with_type(type, [&](auto example) {
        parse_into<decltype(example)>(text_of(source.bytes.subspan(std::size_t(skip))), count, out,
                                      type == ScalarType::float16);
      });
      return shared(std::move(out));
    }
  }
  if (all.size() < skip + needed)
    truncated("its numbers, decompressed,", double(needed), double(all.size()) - double(skip));
  return all.from(std::size_t(skip));
}

namespace {

/// Decompresses deflated data, whose header is that of `window_bits` (inflateInit2).
SharedBytes inflated(const SharedBytes& source, std::uint64_t wanted, int window_bits) {
  require_content(double(wanted), double(source.size()), kContentPerByte);
  z_stream stream{};
  if (inflateInit2(&stream, window_bits) != Z_OK) throw std::bad_alloc();
  struct End {
    z_stream* stream;
    ~End() { inflateEnd(stream); }
  } end{&stream};
  return decompressed(
      source, wanted, stream, [](z_stream& s) { return inflate(&s, Z_NO_FLUSH); },
      [&](int status, bool is_stuck, std::size_t read) {
        // A file of gzip may have several members.
        if (status == Z_STREAM_END)
          return window_bits > 0 && read < source.size() && inflateReset(&stream) == Z_OK;
        if (status == Z_BUF_ERROR && is_stuck) return false;  // the source has ended
        if (status != Z_OK) throw Error("holds damaged data compressed by gzip or zlib");
        return true;
      });
}

}  // namespace

SharedBytes inflate_bytes(const SharedBytes& source, std::uint64_t wanted) {
  constexpr int kGzipOrZlib = 15 + 32;
  return inflated(source, wanted, kGzipOrZlib);
}

SharedBytes inflate_raw(const SharedBytes& source, std::uint64_t wanted) {
  constexpr int kWithoutHeader = -15;
  const SharedBytes all = inflated(source, wanted, kWithoutHeader);
  if (all.size() < wanted) truncated("decompressed data", double(wanted), double(all.size()));
  return all;
}

std::vector<std::byte> base64_bytes(std::string_view text) {
  const auto value = [](char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  };
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (is_blank(c)) continue;
    if (c == '=') break;
    const int v = value(c);
    if (v < 0) throw Error("has a character in its base64 data that does not belong there");
    bits = bits << 6 | unsigned(v);
    if (++count % 4 == 0) {
      for (const int shift : {16, 8, 0}) out.push_back(std::byte(bits >> shift & 255));
      bits = 0;
    }
  }
  if (count % 4 >= 2) out.push_back(std::byte(bits >> (count % 4 == 2 ? 4 : 10) & 255));
  if (count % 4 == 3) out.push_back(std::byte(bits >> 2 & 255));
  return out;
}

Error at_line(const Error& problem, int line) {
  const bool is_elsewhere = !problem.where().file.empty();
  return Error({{}, line, 0}, is_elsewhere ? "names a file that is not read: " + std::string(problem.what())
                                           : problem.message());
}

double number_of(std::string_view text) {
  std::string_view t = trimmed(text);
  if (t.starts_with('+')) t.remove_prefix(1);
  double value = 0;
  const auto [end, fault] = std::from_chars(t.data(), t.data() + t.size(), value);
  const bool is_read = end == t.data() + t.size() && !t.empty();
  if (is_read && fault == std::errc::result_out_of_range) return t.find('-') == 0 ? -INFINITY : INFINITY;
  if (!is_read || fault != std::errc())
    throw Error(fmt::format("has \"{}\" where a number is expected, such as 0.5", text.substr(0, 40)));
  return value;
}

std::int64_t integer_of(std::string_view text) {
  std::string_view t = trimmed(text);
  if (t.starts_with('+')) t.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(t.data(), t.data() + t.size(), value);
  if (end != t.data() + t.size() || fault != std::errc() || t.empty())
    throw Error(fmt::format("has \"{}\" where a whole number is expected, such as 64", text.substr(0, 40)));
  return value;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < text.size();) {
    if (is_blank(text[i])) {
      ++i;
      continue;
    }
    const std::size_t begin = i;
    while (i < text.size() && !is_blank(text[i])) ++i;
    words.emplace_back(text.substr(begin, i - begin));
  }
  return words;
}

std::vector<double> numbers_of(std::string_view text, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(text)) numbers.push_back(number_of(word));
  if (numbers.size() != count)
    throw Error(
        fmt::format("has {} numbers in \"{}\"; {} are expected", numbers.size(), text.substr(0, 80), count));
  return numbers;
}

std::vector<std::int64_t> integers_of(std::string_view text) {
  std::vector<std::int64_t> numbers;
  for (const std::string& word : words_of(text)) numbers.push_back(integer_of(word));
  return numbers;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lowered(std::string_view text) {
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return low;
}

std::optional<double> metres_of_unit(std::string_view name) {
  static const std::map<std::string, double, std::less<>> kNames = {{"m", 1},
                                                                    {"meter", 1},
                                                                    {"metre", 1},
                                                                    {"meters", 1},
                                                                    {"metres", 1},
                                                                    {"cm", 1e-2},
                                                                    {"centimeter", 1e-2},
                                                                    {"centimetre", 1e-2},
                                                                    {"mm", 1e-3},
                                                                    {"millimeter", 1e-3},
                                                                    {"millimetre", 1e-3},
                                                                    {"um", 1e-6},
                                                                    {"\u00b5m", 1e-6},
                                                                    {"\u03bcm", 1e-6},
                                                                    {"micron", 1e-6},
                                                                    {"micrometer", 1e-6},
                                                                    {"micrometre", 1e-6},
                                                                    {"nm", 1e-9},
                                                                    {"nanometer", 1e-9},
                                                                    {"nanometre", 1e-9},
                                                                    {"km", 1e3},
                                                                    {"kilometer", 1e3},
                                                                    {"in", 0.0254},
                                                                    {"inch", 0.0254}};
  std::string low = lowered(trimmed(name));
  auto found = kNames.find(low);
  if (found == kNames.end() && low.ends_with('s')) low.pop_back(), found = kNames.find(low);
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

void arrange(ScalarGrid& grid, const std::vector<GridAxis>& axes, const ScalarGridOptions& options) {
  std::int64_t stride = 1;
  std::vector<std::array<std::int64_t, 2>> frames;  // size and stride of each axis of frames
  grid.strides = {0, 0, 0, 0};
  grid.channels = 1;
  std::int64_t frame_count = 1;
  for (const GridAxis& a : axes) {
    if (const auto k = std::string_view("xyz").find(a.role); k != std::string_view::npos)
      grid.size[k] = int(a.size), grid.strides[k] = stride;
    else if (a.role == 'c') {
      if (a.size > 64) throw Error(fmt::format("has {} numbers in a voxel; 1 to 64 are possible", a.size));
      grid.channels = int(a.size), grid.strides[3] = stride;
    } else
      frames.push_back({a.size, stride}), frame_count *= a.size;
    stride *= a.size;
  }
  if (frame_count > std::numeric_limits<int>::max()) throw Error("has too many grids");
  grid.frames = int(frame_count);
  if (options.frame < 0 || options.frame >= grid.frames)
    throw Error(fmt::format("has no frame {}: it has {}, counted from 0", options.frame, grid.frames));
  std::int64_t first = 0, frame = options.frame;
  for (const auto& [size, step] : frames) first += frame % size * step, frame /= size;
  grid.numbers = grid.numbers.from(std::size_t(first) * bytes_of(grid.type));
}

void place(ScalarGrid& grid, const std::array<std::array<double, 3>, 3>& columns,
           const std::array<double, 3>& origin, const std::string& space, const ScalarGridOptions& options) {
  grid.space = options.space.empty() ? space : options.space;
  const char toward[3] = {'L', 'P', 'I'};  // letters of the directions opposite to RAS
  Transform::Matrix m{};
  m[3][3] = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double sign = grid.space.size() == 3 && grid.space[i] == toward[i] ? -1 : 1;
    for (std::size_t k = 0; k < 3; ++k) m[i][k] = sign * columns[k][i];
    m[i][3] = sign * origin[i];
  }
  // bounds of lengths whose products stay within double precision
  constexpr double kLeast = 1e-15, kMost = 1e15;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = std::hypot(columns[k][0], columns[k][1], columns[k][2]);
    if (!(length >= kLeast && length <= kMost))
      throw Error(
          fmt::format("has voxels at a distance of {} along its axis {}; a positive, finite distance "
                      "is expected, such as 0.5",
                      length, "xyz"[k]));
    if (!(std::abs(origin[k]) <= kMost))
      throw Error(fmt::format("has its first voxel at ({}, {}, {}); finite coordinates are expected",
                              origin[0], origin[1], origin[2]));
  }
  // Determinant of the unit vectors along the axes: 1 at right angles, 0 in one plane.
  Transform::Matrix unit = m;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = std::hypot(m[0][k], m[1][k], m[2][k]);
    for (std::size_t i = 0; i < 3; ++i) unit[i][k] /= length;
  }
  if (!(std::abs(Transform(unit).determinant3()) > 1e-6))
    throw Error(
        fmt::format("has axes in one plane: along ({}, {}, {}), ({}, {}, {}) and ({}, {}, {}); axes at "
                    "right angles are usual",
                    columns[0][0], columns[0][1], columns[0][2], columns[1][0], columns[1][1], columns[1][2],
                    columns[2][0], columns[2][1], columns[2][2]));
  grid.index_to_ras = Transform(m);
  if (options.unit_m) grid.unit_m = *options.unit_m;
}

void place_by_options(ScalarGrid& grid, const ScalarGridOptions& options) {
  const std::array<double, 3> step = options.spacing.value_or(std::array<double, 3>{1, 1, 1});
  grid.spacing_is_stated = false;
  place(grid, {{{step[0], 0, 0}, {0, step[1], 0}, {0, 0, step[2]}}},
        options.origin.value_or(std::array<double, 3>{0, 0, 0}), "", options);
}

std::vector<std::string> names_of_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                          std::int64_t step) {
  const std::size_t at = pattern.find('%');
  std::size_t end = at == pattern.npos ? at : at + 1;
  std::size_t width = 0;
  bool zeros = false;
  if (at != pattern.npos) {
    if (end < pattern.size() && pattern[end] == '0') zeros = true, ++end;
    while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9' && width < 100)
      width = 10 * width + std::size_t(pattern[end++] - '0');
    if (end < pattern.size() && pattern[end] == '.') {  // a pattern such as %.3d has leading zeros as well
      zeros = true, width = 0, ++end;
      while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9' && width < 100)
        width = 10 * width + std::size_t(pattern[end++] - '0');
    }
  }
  const bool is_number =
      end < pattern.size() && (pattern[end] == 'd' || pattern[end] == 'i' || pattern[end] == 'u');
  if (at == pattern.npos || !is_number || pattern.find('%', end) != pattern.npos || width > 99)
    throw Error(fmt::format("has the pattern \"{}\" of names; it needs one number, as in slice%03d.raw",
                            pattern.substr(0, 80)));
  constexpr std::int64_t kFarthest = std::int64_t(1) << 40;
  if (step == 0 || (step > 0) != (last >= first) || std::abs(first) > kFarthest ||
      std::abs(last) > kFarthest || std::abs(step) > kFarthest ||
      std::uint64_t((last - first) / step) >= kMaxFiles)
    throw Error(fmt::format("has files numbered from {} to {} by {}; 1 to {} files are possible", first, last,
                            step, kMaxFiles));
  std::vector<std::string> names;
  for (std::int64_t i = first; step > 0 ? i <= last : i >= last; i += step) {
    std::string number = std::to_string(i);
    if (number.size() < width) number.insert(0, width - number.size(), zeros ? '0' : ' ');
    names.push_back(pattern.substr(0, at) + number + pattern.substr(end + 1));
  }
  return names;
}

std::vector<Path> files_of_series(const Path& file) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::string name = file.filename().string();
  std::size_t end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  if (begin == end)
    throw Error("has no number in its name; the slices of a series are numbered, as in slice001.tif");
  const std::string before = name.substr(0, begin), after = name.substr(end);
  std::vector<std::pair<std::int64_t, Path>> found;
  std::error_code fault;
  const Path folder = file.has_parent_path() ? file.parent_path() : Path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
    const std::string other = entry.path().filename().string();
    if (other.size() <= before.size() + after.size() || !other.starts_with(before) || !other.ends_with(after))
      continue;
    const std::string number = other.substr(before.size(), other.size() - before.size() - after.size());
    if (number.size() > 15 || !std::all_of(number.begin(), number.end(), is_digit)) continue;
    found.emplace_back(integer_of(number), entry.path());
    if (found.size() > kMaxFiles)
      throw Error(fmt::format("is one of more than {} slices, which are too many", kMaxFiles));
  }
  if (fault) throw Error("is in a folder that cannot be listed: " + fault.message());
  std::sort(found.begin(), found.end());
  std::vector<Path> files;
  const std::int64_t step = found.size() > 1 ? found[1].first - found[0].first : 1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].first - found[i - 1].first != step)
      throw Error(fmt::format("is one of a series with a gap or a number twice: {} is followed by {}",
                              found[i - 1].second.filename().string(), found[i].second.filename().string()));
    files.push_back(found[i].second);
  }
  return files;
}

}  // namespace aureole::grid_reader
