// SPDX-License-Identifier: Apache-2.0
// Layout: "OpenEXR File Layout" (openexr.com): magic number, version and flags, then per part attributes of
// name, type, size, value. An empty name ends a header; an empty header ends the headers of a multi-part
// file.
#include "aureole/core/exr_header.h"

#include <cstdint>
#include <cstring>
#include <string>

#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

constexpr std::uint32_t kDeep = 0x800, kMultiPart = 0x1000;
/// Upper bound of the compression ratio of whole images over all compression methods of the format.
constexpr double kMaxRatio = 20000;

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

/// Returns the bytes of one pixel from the list of channels.
double pixel_bytes(Bytes list) {
  double sum = 0;
  for (Cursor c(list); !c.text().empty();) {
    const std::int32_t type = c.integer();
    c.take(12);  // skips linearity and sampling
    sum += type == 1 ? 2 : 4;
  }
  return sum;
}

}  // namespace

void check_exr_header(Bytes bytes, std::size_t max_pixels) {
  Cursor c(bytes);
  c.take(4);
  const auto version = std::uint32_t(c.integer());
  if (version & kDeep) throw Error("a deep EXR, which is not supported");
  for (bool more = true; more;) {
    double per_pixel = 0;
    long long width = 0, height = 0;
    double tile = 0;
    bool empty = true;
    for (std::string name = c.text(); !name.empty(); name = c.text()) {
      empty = false;
      const std::string type = c.text();
      const std::int32_t size = c.integer();
      if (size < 0) throw Error("damaged EXR: an attribute of negative size");
      const Bytes value = c.take(std::size_t(size));
      if (name == "channels") per_pixel = pixel_bytes(value);
      if (name == "dataWindow" && size == 16) {
        width = 1LL + Cursor::integer_at(value.subspan(8)) - Cursor::integer_at(value);
        height = 1LL + Cursor::integer_at(value.subspan(12)) - Cursor::integer_at(value.subspan(4));
      }
      if (name == "tiles" && size >= 8)
        tile = double(std::uint32_t(Cursor::integer_at(value))) *
               std::uint32_t(Cursor::integer_at(value.subspan(4)));
    }
    if (!empty) {
      check_size(width, height, max_pixels, bytes.size(), kMaxRatio / (per_pixel > 0 ? per_pixel : 1));
      if (tile * per_pixel > kMaxRatio * (double(bytes.size()) + 64))
        throw Error("damaged EXR: impossible tiles");
    }
    more = (version & kMultiPart) && !empty;
  }
}

}  // namespace aureole::codec
