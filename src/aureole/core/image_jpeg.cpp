// SPDX-License-Identifier: Apache-2.0
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
// jpeglib.h requires size_t and FILE to be declared before it.
#include <jerror.h>
#include <jpeglib.h>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

/// State of libjpeg's callbacks. libjpeg reports errors by longjmp, so functions that call setjmp have no
/// local objects with destructors.
struct JpegState {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX] = "";
  std::vector<unsigned char> data;
  unsigned char* profile = nullptr;  ///< ICC profile of the file, freed by free()
  unsigned profile_size = 0;
};

/// State of writing; functions that use it have no local objects with destructors either.
struct JpegWriter {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX] = "";
  const unsigned char* data = nullptr;
  const unsigned char* profile = nullptr;
  unsigned profile_size = 0;
  unsigned char* output = nullptr;  ///< encoded bytes, freed by free()
  unsigned long output_size = 0;
};

void on_write_error(j_common_ptr jpeg) {
  auto* state = static_cast<JpegWriter*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, state->message);
  std::longjmp(state->jump, 1);
}

bool write_all(JpegWriter& s, int width, int height, int channels, int quality) {
  if (setjmp(s.jump)) return false;
  jpeg_create_compress(&s.jpeg);
  jpeg_mem_dest(&s.jpeg, &s.output, &s.output_size);
  s.jpeg.image_width = JDIMENSION(width), s.jpeg.image_height = JDIMENSION(height);
  s.jpeg.input_components = channels, s.jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&s.jpeg);
  jpeg_set_quality(&s.jpeg, quality, TRUE);
  s.jpeg.optimize_coding = TRUE;
  if (quality >= 90 && channels == 3)
    s.jpeg.comp_info[0].h_samp_factor = s.jpeg.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&s.jpeg, TRUE);
  if (channels == 3) jpeg_write_icc_profile(&s.jpeg, s.profile, s.profile_size);
  while (s.jpeg.next_scanline < s.jpeg.image_height) {
    auto* row =
        const_cast<JSAMPROW>(s.data + std::size_t(s.jpeg.next_scanline) * std::size_t(width * channels));
    jpeg_write_scanlines(&s.jpeg, &row, 1);
  }
  jpeg_finish_compress(&s.jpeg);
  return true;
}

void on_error(j_common_ptr jpeg) {
  auto* state = static_cast<JpegState*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, state->message);
  std::longjmp(state->jump, 1);
}

/// Treats warnings about missing pixels, which libjpeg fills with grey, as errors. Other warnings are
/// harmless.
void on_message(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  const int code = jpeg->err->msg_code;
  if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE) on_error(jpeg);
}

bool read_header(JpegState& s, Bytes bytes) {
  if (setjmp(s.jump)) return false;
  jpeg_create_decompress(&s.jpeg);
  jpeg_mem_src(&s.jpeg, bytes.data(), static_cast<unsigned long>(bytes.size()));
  jpeg_save_markers(&s.jpeg, JPEG_APP0 + 2, 0xFFFF);
  jpeg_read_header(&s.jpeg, TRUE);
  if (!jpeg_read_icc_profile(&s.jpeg, &s.profile, &s.profile_size)) s.profile_size = 0;
  const bool cmyk = s.jpeg.jpeg_color_space == JCS_CMYK || s.jpeg.jpeg_color_space == JCS_YCCK;
  s.jpeg.out_color_space = s.jpeg.num_components == 1 ? JCS_GRAYSCALE : cmyk ? JCS_CMYK : JCS_RGB;
  return true;
}

bool read_rows(JpegState& s) {
  if (setjmp(s.jump)) return false;
  jpeg_start_decompress(&s.jpeg);
  const std::size_t row_bytes = std::size_t(s.jpeg.output_width) * s.jpeg.output_components;
  while (s.jpeg.output_scanline < s.jpeg.output_height) {
    JSAMPROW row = s.data.data() + s.jpeg.output_scanline * row_bytes;
    jpeg_read_scanlines(&s.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&s.jpeg);
  return true;
}

}  // namespace

Image read_jpeg(Bytes bytes, std::size_t max_pixels) {
  JpegState s;
  s.jpeg.err = jpeg_std_error(&s.errors);
  s.errors.error_exit = on_error;
  s.errors.emit_message = on_message;
  s.jpeg.client_data = &s;
  struct Guard {
    JpegState& s;
    ~Guard() {
      jpeg_destroy_decompress(&s.jpeg);
      std::free(s.profile);
    }
  } guard{s};
  const auto check = [&](bool good) {
    if (!good) throw Error(std::string("damaged JPEG: ") + s.message);
  };
  check(read_header(s, bytes));
  const int width = int(s.jpeg.image_width), height = int(s.jpeg.image_height);
  // A block of 64 pixels takes at least one bit, which bounds the number of pixels.
  check_size(width, height, s.jpeg.num_components, max_pixels, bytes.size(), 8 * 64);
  const int components = s.jpeg.out_color_space == JCS_GRAYSCALE ? 1
                         : s.jpeg.out_color_space == JCS_CMYK    ? 4
                                                                 : 3;
  s.data.resize(std::size_t(width) * height * components);
  check(read_rows(s));
  const auto* v = s.data.data();
  // Four-ink (CMYK) files store inverted values, as Adobe's programs do.
  Image image = components != 4 ? make_image(width, height, components, true,
                                             [&](std::size_t i) { return float(v[i]) / 255; })
                                : make_image(width, height, 3, true, [&](std::size_t i) {
                                    const unsigned char* pixel = v + i / 3 * 4;
                                    return float(pixel[i % 3]) * float(pixel[3]) / (255.f * 255.f);
                                  });
  if (components != 4)
    image.profile.assign(s.profile, s.profile + s.profile_size);
  else if (s.profile_size > 0)
    image.notes.push_back("the colour profile of the JPEG's four inks is not used");
  image.format = components == 4 ? "JPEG, 8 bits per channel, four inks (CMYK)" : "JPEG, 8 bits per channel";
  return image;
}

std::vector<char> encode_jpeg(const Image& image, int quality) {
  const int channels = int(image.channel_count());
  if (channels != 1 && channels != 3)
    throw Error("a JPEG has one or three channels, not " + std::to_string(channels));
  if (image.width <= 0 || image.height <= 0 || image.width > 65500 || image.height > 65500)
    throw Error("a JPEG has 1 to 65500 pixels a side, not " + std::to_string(image.width) + " x " +
                std::to_string(image.height));
  std::vector<unsigned char> data(image.pixels.size());
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = integer_value<unsigned char>(image.pixels[i]);
  const std::vector<unsigned char>& profile = srgb_profile(false);
  JpegWriter s;
  s.jpeg.err = jpeg_std_error(&s.errors);
  s.errors.error_exit = on_write_error;
  s.jpeg.client_data = &s;
  s.data = data.data(), s.profile = profile.data(), s.profile_size = unsigned(profile.size());
  struct Guard {
    JpegWriter& s;
    ~Guard() {
      jpeg_destroy_compress(&s.jpeg);
      std::free(s.output);
    }
  } guard{s};
  if (!write_all(s, image.width, image.height, channels, quality))
    throw Error(std::string("the JPEG cannot be made: ") + s.message);
  return {s.output, s.output + s.output_size};
}

}  // namespace aureole::codec
