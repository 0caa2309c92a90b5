// SPDX-License-Identifier: Apache-2.0
// Layout: "OpenEXR File Layout" (openexr.com): magic number, version and flags, then per part attributes of
// name, type, size, value. An empty name ends a header; an empty header ends the headers of a multi-part
// file.
#include "aureole/core/exr_header.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"
#include "aureole/core/memory.h"

namespace aureole::codec {

namespace {

constexpr std::uint32_t kDeep = 0x800, kMultiPart = 0x1000;
/// Upper bound of the compression ratio of whole images over all compression methods of the format.
constexpr double kMaxRatio = 20000;
/// Bound of the bytes of a decompressed chunk, counted twice, for each byte of the file: a whole picture may
/// be one chunk, but its file is large then.
constexpr double kChunkBytesPerByte = 16;

class Cursor {
public:
  explicit Cursor(Bytes bytes) : bytes_(bytes) {}
  Bytes take(std::size_t n) {
    if (n > bytes_.size()) throw Error("the file is truncated: its header does not end");
    const Bytes r = bytes_.first(n);
    bytes_ = bytes_.subspan(n);
    return r;
  }
  std::string text() {
    const auto* end = static_cast<const unsigned char*>(std::memchr(bytes_.data(), 0, bytes_.size()));
    if (!end) throw Error("the file is truncated: its header does not end");
    const Bytes b = take(std::size_t(end - bytes_.data()) + 1);
    return {reinterpret_cast<const char*>(b.data()), b.size() - 1};
  }
  std::int32_t integer() { return integer_at(take(4)); }
  static std::int32_t integer_at(Bytes b) {
    return std::int32_t(std::uint32_t(b[0]) | std::uint32_t(b[1]) << 8 | std::uint32_t(b[2]) << 16 |
                        std::uint32_t(b[3]) << 24);
  }

private:
  Bytes bytes_;
};

struct Channels {
  double count = 0, pixel_bytes = 0;
};

Channels channels_of(Bytes list) {
  Channels sum;
  for (Cursor c(list); !c.text().empty(); ++sum.count) {
    const std::int32_t type = c.integer();
    c.take(12);  // skips linearity and sampling
    sum.pixel_bytes += type == 1 ? 2 : 4;
  }
  return sum;
}

/// Number of lines that a compression method stores together, by its number in the format: none, RLE, ZIPS,
/// ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
double lines_together(unsigned compression) {
  constexpr double kLines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < std::size(kLines) ? kLines[compression] : 1;
}

/// Sizes that the header of a part states.
struct Part {
  Channels channels;
  double width = 0, height = 0, tile_width = 0, tile_height = 0, lines = 1, chunk_count = 0;
};

/// Throws Error where the library would allocate more than a file of this size can fill, or than the picture
/// may need.
void check_part(const Part& part, std::size_t file_bytes, std::size_t max_pixels) {
  const double pixel_bytes = std::max(part.channels.pixel_bytes, 1.0);
  check_size((long long)part.width, (long long)part.height, part.channels.count, max_pixels, file_bytes,
             kMaxRatio / pixel_bytes);
  const bool tiled = part.tile_width > 0 && part.tile_height > 0;
  // A chunk, a row of tiles or some lines, is in memory several times while it is decompressed.
  const double rows = tiled ? part.tile_height : part.lines;
  const double chunk = std::max(part.width, part.tile_width) * rows * pixel_bytes;
  require_content(2 * chunk, double(file_bytes), kChunkBytesPerByte);
  const double chunks = tiled ? std::ceil(part.width / part.tile_width) * std::ceil(part.height / rows)
                              : std::ceil(part.height / rows);
  constexpr double kOffsetBytes = 8;
  if (std::max(chunks, part.chunk_count) * kOffsetBytes > double(file_bytes))
    throw Error("the file is truncated or damaged: its table of " +
                std::to_string((long long)std::max(chunks, part.chunk_count)) + " chunks cannot be in " +
                std::to_string(file_bytes) + " bytes");
}

}  // namespace

int check_exr_header(Bytes bytes, std::size_t max_pixels) {
  Cursor c(bytes);
  c.take(4);
  const auto version = std::uint32_t(c.integer());
  const Error deep("a deep EXR, which is not supported");
  if (version & kDeep) throw deep;
  int parts = 0;
  for (bool more = true; more;) {
    Part part;
    bool empty = true;
    for (std::string name = c.text(); !name.empty(); name = c.text()) {
      empty = false;
      const std::string type = c.text();
      const std::int32_t size = c.integer();
      if (size < 0) throw Error("damaged EXR: an attribute of negative size");
      const Bytes value = c.take(std::size_t(size));
      if (name == "channels") part.channels = channels_of(value);
      if (name == "dataWindow" && size == 16) {
        part.width = 1.0 + Cursor::integer_at(value.subspan(8)) - Cursor::integer_at(value);
        part.height = 1.0 + Cursor::integer_at(value.subspan(12)) - Cursor::integer_at(value.subspan(4));
      }
      if (name == "tiles" && size >= 8) {
        part.tile_width = std::uint32_t(Cursor::integer_at(value));
        part.tile_height = std::uint32_t(Cursor::integer_at(value.subspan(4)));
      }
      if (name == "compression" && size == 1) part.lines = lines_together(value[0]);
      if (name == "chunkCount" && size == 4) part.chunk_count = Cursor::integer_at(value);
      if (name == "type" &&
          std::string_view(reinterpret_cast<const char*>(value.data()), value.size()).starts_with("deep"))
        throw deep;
    }
    if (!empty) check_part(part, bytes.size(), max_pixels), ++parts;
    more = (version & kMultiPart) && !empty;
  }
  return parts;
}

}  // namespace aureole::codec
