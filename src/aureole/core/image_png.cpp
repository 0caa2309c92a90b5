// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <stdexcept>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

/// State of libpng's callbacks. libpng reports errors by longjmp, so functions that call setjmp have no local
/// objects with destructors.
struct PngState {
  Bytes input;
  std::size_t position = 0;
  std::vector<char> output;
  char message[128] = "";
  std::size_t max_pixels = 0;

  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<unsigned char> data;
  std::vector<png_bytep> rows;
  int width = 0, height = 0, channels = 0, bits = 8;
  /// Colour space as the file states it: bytes of an ICC profile, or primaries and the exponent of encoding,
  /// 0 if unstated.
  png_bytep profile = nullptr;
  png_uint_32 profile_size = 0;
  char profile_problem[128] = "";
  bool is_srgb = false, has_primaries = false;
  double primaries[8] = {}, gamma = 0;
};

void on_error(png_structp png, png_const_charp message) {
  auto* state = static_cast<PngState*>(png_get_error_ptr(png));
  std::snprintf(state->message, sizeof state->message, "%s", message);
  std::longjmp(png_jmpbuf(png), 1);
}
/// Keeps the reason for which libpng does not use a colour profile; its other warnings are harmless.
void on_warning(png_structp png, png_const_charp message) {
  auto* state = static_cast<PngState*>(png_get_error_ptr(png));
  if (std::strncmp(message, "iCCP", 4) == 0)
    std::snprintf(state->profile_problem, sizeof state->profile_problem, "%s", message);
}

void on_read(png_structp png, png_bytep to, std::size_t n) {
  auto* state = static_cast<PngState*>(png_get_io_ptr(png));
  if (n > state->input.size() - state->position) png_error(png, "the file is truncated");
  std::memcpy(to, state->input.data() + state->position, n);
  state->position += n;
}

void on_write(png_structp png, png_bytep from, std::size_t n) {
  auto* state = static_cast<PngState*>(png_get_io_ptr(png));
  try {
    state->output.insert(state->output.end(), from, from + n);
  } catch (const std::bad_alloc&) {
    png_error(png, "not enough memory");
  }
}
void on_flush(png_structp) {}

void read_colors(PngState& s) {
  png_charp name = nullptr;
  int compression = 0, intent = 0;
  s.is_srgb = png_get_sRGB(s.png, s.info, &intent) != 0;
  if (!png_get_iCCP(s.png, s.info, &name, &compression, &s.profile, &s.profile_size)) s.profile_size = 0;
  double* p = s.primaries;
  s.has_primaries = png_get_cHRM(s.png, s.info, p + 6, p + 7, p, p + 1, p + 2, p + 3, p + 4, p + 5) != 0;
  if (!png_get_gAMA(s.png, s.info, &s.gamma)) s.gamma = 0;
}

bool read_header(PngState& s) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  png_set_read_fn(s.png, &s, on_read);
  png_read_info(s.png, s.info);
  s.width = int(png_get_image_width(s.png, s.info)), s.height = int(png_get_image_height(s.png, s.info));
  read_colors(s);
  png_set_expand(s.png);  // converts palettes to RGB, fewer bits to 8, transparency to alpha
  if (png_get_bit_depth(s.png, s.info) == 16) png_set_swap(s.png), s.bits = 16;
  png_set_interlace_handling(s.png);
  png_read_update_info(s.png, s.info);
  s.channels = png_get_channels(s.png, s.info);
  return true;
}

bool read_rows(PngState& s) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  png_read_image(s.png, s.rows.data());
  png_read_end(s.png, nullptr);
  return true;
}

bool write_rows(PngState& s) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  png_set_write_fn(s.png, &s, on_write, on_flush);
  const int type = s.channels == 1   ? PNG_COLOR_TYPE_GRAY
                   : s.channels == 2 ? PNG_COLOR_TYPE_GRAY_ALPHA
                   : s.channels == 3 ? PNG_COLOR_TYPE_RGB
                                     : PNG_COLOR_TYPE_RGB_ALPHA;
  png_set_IHDR(s.png, s.info, png_uint_32(s.width), png_uint_32(s.height), s.bits, type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(s.png, s.info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(s.png, s.info);
  if (s.bits == 16) png_set_swap(s.png);
  png_write_image(s.png, s.rows.data());
  png_write_end(s.png, nullptr);
  return true;
}

void point_rows(PngState& s, std::size_t row_bytes) {
  s.data.resize(row_bytes * std::size_t(s.height));
  s.rows.resize(std::size_t(s.height));
  for (std::size_t y = 0; y < s.rows.size(); ++y) s.rows[y] = s.data.data() + y * row_bytes;
}

}  // namespace

Image read_png(Bytes bytes, std::size_t max_pixels) {
  PngState s;
  s.input = bytes;
  s.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &s, on_error, on_warning);
  if (!s.png) throw Error("libpng cannot be started");
  struct Guard {
    PngState& s;
    ~Guard() { png_destroy_read_struct(&s.png, &s.info, nullptr); }
  } guard{s};
  s.info = png_create_info_struct(s.png);
  if (!s.info) throw Error("libpng cannot be started");
  if (!read_header(s)) throw Error(std::string("damaged PNG: ") + s.message);
  // Bound of the pixels: a byte of deflated data expands to at most 1032 bytes, each with at most 8 pixels.
  check_size(s.width, s.height, s.channels, max_pixels, bytes.size(), 1032 * 8);
  point_rows(s, png_get_rowbytes(s.png, s.info));
  if (!read_rows(s)) throw Error(std::string("damaged PNG: ") + s.message);
  const auto* v = reinterpret_cast<const std::uint16_t*>(s.data.data());
  Image image = s.bits == 16 ? make_image(s.width, s.height, s.channels, true,
                                          [&](std::size_t i) { return float(v[i]) / 65535; })
                             : make_image(s.width, s.height, s.channels, true,
                                          [&](std::size_t i) { return float(s.data[i]) / 255; });
  image.format = "PNG, " + std::to_string(s.bits) + " bits per channel";
  // Of several statements about colour the PNG specification prefers the profile, then sRGB, then primaries
  // and exponent.
  if (s.profile_size > 0) {
    image.profile.assign(s.profile, s.profile + s.profile_size);
  } else if (*s.profile_problem) {
    image.notes.push_back(std::string("the colour profile in the PNG is not used (") + s.profile_problem +
                          "): its colours are taken for sRGB");
  } else if (!s.is_srgb && s.gamma > 0 && (s.has_primaries || std::abs(s.gamma - 1 / 2.2) > 0.01)) {
    Primaries primaries = kSrgbPrimaries;
    const bool is_usual = std::abs(s.gamma - 1 / 2.2) <= 0.01;
    bool differs = !is_usual;
    for (std::size_t i = 0; s.has_primaries && i < primaries.size(); ++i) {
      differs = differs || std::abs(primaries[i] - s.primaries[i]) > 0.002;
      primaries[i] = s.primaries[i];
    }
    // An exponent of 1/2.2 with the primaries of sRGB stands for sRGB.
    if (differs) image.profile = profile_of_primaries(primaries, 1 / s.gamma);
  }
  return image;
}

std::vector<char> encode_png(const Image& image, int bits) {
  PngState s;
  s.width = image.width, s.height = image.height, s.channels = int(image.channel_count());
  if (s.channels < 1 || s.channels > 4)
    throw Error("a PNG has one to four channels, not " + std::to_string(s.channels));
  s.bits = bits;
  if (s.width <= 0 || s.height <= 0) throw Error("the image has no pixels");
  s.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &s, on_error, on_warning);
  if (!s.png) throw Error("libpng cannot be started");
  struct Guard {
    PngState& s;
    ~Guard() { png_destroy_write_struct(&s.png, &s.info); }
  } guard{s};
  s.info = png_create_info_struct(s.png);
  if (!s.info) throw Error("libpng cannot be started");
  point_rows(s, std::size_t(s.width) * s.channels * (bits / 8));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (bits == 16) {
      const std::uint16_t v = integer_value<std::uint16_t>(image.pixels[i]);
      std::memcpy(s.data.data() + 2 * i, &v, 2);
    } else {
      s.data[i] = integer_value<unsigned char>(image.pixels[i]);
    }
  }
  if (!write_rows(s)) throw Error(std::string("the PNG cannot be made: ") + s.message);
  return std::move(s.output);
}

}  // namespace aureole::codec
