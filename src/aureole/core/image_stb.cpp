// SPDX-License-Identifier: Apache-2.0
// The formats read through stb_image: HDR, TGA, BMP.
#include <algorithm>
#include <cstring>
#include <memory>

#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace aureole::codec {

namespace {

/// Feeds stb_image and notes when it asks for bytes beyond the end: it takes them as zeros and calls that a success.
struct Feed {
  Bytes bytes;
  std::size_t position = 0;
  const char* buffer = nullptr;  ///< stb_image's own; refilling it may come up short, anything else may not
  bool short_read = false;

  static int read(void* user, char* to, int wanted) {
    auto& f = *static_cast<Feed*>(user);
    if (!f.buffer) f.buffer = to;
    const std::size_t n = std::min(std::size_t(wanted), f.bytes.size() - f.position);
    std::memcpy(to, f.bytes.data() + f.position, n);
    f.position += n;
    if (to == f.buffer ? n == 0 : n < std::size_t(wanted)) f.short_read = true;
    return int(n);
  }
  static void skip(void* user, int n) {
    auto& f = *static_cast<Feed*>(user);
    const long long to = (long long)f.position + n;
    if (to < 0 || to > (long long)f.bytes.size()) f.short_read = true;
    f.position = std::size_t(std::clamp<long long>(to, 0, (long long)f.bytes.size()));
  }
  static int end(void* user) {
    auto& f = *static_cast<Feed*>(user);
    return f.position >= f.bytes.size();
  }
};

constexpr stbi_io_callbacks kCallbacks = {Feed::read, Feed::skip, Feed::end};

}  // namespace

Image read_hdr_tga_bmp(Bytes bytes, std::size_t max_pixels) {
  int width = 0, height = 0, channels = 0;
  Feed probe{bytes};
  if (!stbi_info_from_callbacks(&kCallbacks, &probe, &width, &height, &channels))
    throw Error("unknown or damaged image; EXR, PNG, JPEG, TIFF, HDR, TGA and BMP can be read");
  // Run lengths go up to 128.
  check_size(width, height, max_pixels, bytes.size(), 128);

  Feed test{bytes}, feed{bytes};
  const bool hdr = stbi_is_hdr_from_callbacks(&kCallbacks, &test);
  const auto finish = [&](auto* raw, float scale) {
    const std::unique_ptr<std::remove_pointer_t<decltype(raw)>, void (*)(void*)> data(raw, stbi_image_free);
    if (!data) throw Error(std::string("damaged image: ") + stbi_failure_reason());
    if (feed.short_read) throw Error("the file is truncated");
    return make_image(width, height, channels, !hdr, [&](std::size_t i) { return float(raw[i]) * scale; });
  };
  if (hdr) return finish(stbi_loadf_from_callbacks(&kCallbacks, &feed, &width, &height, &channels, 0), 1.f);
  return finish(stbi_load_from_callbacks(&kCallbacks, &feed, &width, &height, &channels, 0), 1 / 255.f);
}

}  // namespace aureole::codec
