// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <stdexcept>

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
};

void on_error(png_structp png, png_const_charp message) {
  auto* state = static_cast<PngState*>(png_get_error_ptr(png));
  std::snprintf(state->message, sizeof state->message, "%s", message);
  std::longjmp(png_jmpbuf(png), 1);
}
void on_warning(png_structp, png_const_charp) {}

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

bool read_header(PngState& s) {
  if (setjmp(png_jmpbuf(s.png))) return false;
  png_set_read_fn(s.png, &s, on_read);
  png_read_info(s.png, s.info);
  s.width = int(png_get_image_width(s.png, s.info)), s.height = int(png_get_image_height(s.png, s.info));
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
                   : s.channels == 3 ? PNG_COLOR_TYPE_RGB
                                     : PNG_COLOR_TYPE_RGB_ALPHA;
  png_set_IHDR(s.png, s.info, png_uint_32(s.width), png_uint_32(s.height), 8, type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(s.png, s.info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(s.png, s.info);
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
  // A byte of deflated data expands to at most 1032 bytes, each with at most 8 pixels.
  check_size(s.width, s.height, s.channels, max_pixels, bytes.size(), 1032 * 8);
  point_rows(s, png_get_rowbytes(s.png, s.info));
  if (!read_rows(s)) throw Error(std::string("damaged PNG: ") + s.message);
  const auto* v = reinterpret_cast<const std::uint16_t*>(s.data.data());
  Image image = s.bits == 16 ? make_image(s.width, s.height, s.channels, true,
                                          [&](std::size_t i) { return float(v[i]) / 65535; })
                             : make_image(s.width, s.height, s.channels, true,
                                          [&](std::size_t i) { return float(s.data[i]) / 255; });
  image.format = "PNG, " + std::to_string(s.bits) + " bits per channel";
  return image;
}

std::vector<char> encode_png(const Image& image) {
  PngState s;
  s.width = image.width, s.height = image.height, s.channels = int(image.channel_count());
  if (s.channels != 1 && s.channels != 3 && s.channels != 4)
    throw Error("a PNG has one, three or four channels, not " + std::to_string(s.channels));
  if (s.width <= 0 || s.height <= 0) throw Error("the image has no pixels");
  s.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &s, on_error, on_warning);
  if (!s.png) throw Error("libpng cannot be started");
  struct Guard {
    PngState& s;
    ~Guard() { png_destroy_write_struct(&s.png, &s.info); }
  } guard{s};
  s.info = png_create_info_struct(s.png);
  if (!s.info) throw Error("libpng cannot be started");
  point_rows(s, std::size_t(s.width) * s.channels);
  for (std::size_t i = 0; i < s.data.size(); ++i) {
    const float v = image.pixels[i];
    s.data[i] = v >= 0 ? static_cast<unsigned char>(std::min(v, 1.f) * 255 + 0.5f) : 0;  // NaN becomes 0
  }
  if (!write_rows(s)) throw Error(std::string("the PNG cannot be made: ") + s.message);
  return std::move(s.output);
}

}  // namespace aureole::codec
