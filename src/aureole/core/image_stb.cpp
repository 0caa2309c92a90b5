// SPDX-License-Identifier: Apache-2.0
// The formats read through stb_image: TGA, BMP.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <unordered_set>

#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {
namespace {

/// Memory allocated by stb_image, freed when an exception passes through it.
class Blocks {
public:
  ~Blocks() {
    for (void* p : live_) std::free(p);
  }
  void* allocate(std::size_t n) { return track(std::malloc(n)); }
  void* resize(void* p, std::size_t n) {
    void* moved = std::realloc(p, n);
    if (moved) live_.erase(p);
    return moved ? track(moved) : nullptr;
  }
  void free(void* p) {
    live_.erase(p);
    std::free(p);
  }

private:
  void* track(void* p) {
    if (p) live_.insert(p);
    return p;
  }
  std::unordered_set<void*> live_;
};
/// The current memory of stb_image in this thread.
thread_local Blocks* blocks = nullptr;

}  // namespace
}  // namespace aureole::codec

#define STBI_MALLOC(n) aureole::codec::blocks->allocate(n)
#define STBI_REALLOC(p, n) aureole::codec::blocks->resize(p, n)
#define STBI_FREE(p) aureole::codec::blocks->free(p)
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
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

/// Provides data to stb_image and throws when it reads beyond the end. stb_image itself would treat missing
/// bytes as zeros and report success, or loop forever.
struct Feed {
  Bytes bytes;
  std::size_t position = 0;
  const char* buffer = nullptr;  ///< stb_image's own buffer; only reads into this buffer may be short

  static int read(void* user, char* to, int wanted) {
    auto& f = *static_cast<Feed*>(user);
    if (!f.buffer) f.buffer = to;
    const std::size_t n = std::min(std::size_t(wanted), f.bytes.size() - f.position);
    std::memcpy(to, f.bytes.data() + f.position, n);
    f.position += n;
    if (to == f.buffer ? n == 0 : n < std::size_t(wanted)) throw Error("the file is truncated");
    return int(n);
  }
  static void skip(void* user, int n) {
    auto& f = *static_cast<Feed*>(user);
    const long long to = (long long)f.position + n;
    if (to < 0 || to > (long long)f.bytes.size()) throw Error("the file is truncated");
    f.position = std::size_t(to);
  }
  static int end(void* user) {
    auto& f = *static_cast<Feed*>(user);
    return f.position >= f.bytes.size();
  }
};

constexpr stbi_io_callbacks kCallbacks = {Feed::read, Feed::skip, Feed::end};

}  // namespace

Image read_tga_bmp(Bytes bytes, std::size_t max_pixels) {
  Blocks held;
  struct Guard {
    explicit Guard(Blocks& b) { blocks = &b; }
    ~Guard() { blocks = nullptr; }
  } guard(held);
  constexpr const char* kUnknown =
      "unknown or damaged image; EXR, PNG, JPEG, TIFF, PFM, HDR, TGA and BMP can be read";
  int width = 0, height = 0, channels = 0;
  Feed probe{bytes}, feed{bytes};
  try {
    if (!stbi_info_from_callbacks(&kCallbacks, &probe, &width, &height, &channels)) throw Error(kUnknown);
  } catch (const Error&) {
    // The file is too short even for a header.
    throw Error(kUnknown);
  }
  // Bound of the pixels: run lengths are at most 128.
  check_size(width, height, channels, max_pixels, bytes.size(), 128);

  const unsigned char* const raw =
      stbi_load_from_callbacks(&kCallbacks, &feed, &width, &height, &channels, 0);
  if (!raw) throw Error(std::string("damaged image: ") + stbi_failure_reason());
  Image image =
      make_image(width, height, channels, true, [&](std::size_t i) { return float(raw[i]) * (1 / 255.f); });
  image.format = bytes.size() > 1 && bytes[0] == 'B' && bytes[1] == 'M' ? "BMP, 8 bits per channel"
                                                                        : "TGA, 8 bits per channel";
  return image;
}

}  // namespace aureole::codec
