// SPDX-License-Identifier: Apache-2.0
// One function per image format, used only by image.cpp. They read from memory and throw Error without the
// file's name.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "aureole/core/image.h"
#include "aureole/core/raw_image.h"

namespace aureole::codec {

using Bytes = std::span<const unsigned char>;

/// Throws Error unless width x height is positive, at most max_pixels, and at most `most_per_byte` pixels per
/// byte of the file. Thus a damaged header cannot cause an allocation that no file of this size can fill.
/// Also throws where the pixels as floats need more than `kPixelBytesPerByte` bytes for each byte of the
/// file.
void check_size(long long width, long long height, double channels, std::size_t max_pixels,
                std::size_t file_bytes, double most_per_byte);

/// Bound of the bytes of an image as floats for each byte of its file. Deflate compresses at most 1032 to 1,
/// and a byte becomes a float: a PNG of one colour has this ratio.
constexpr double kPixelBytesPerByte = 4 * 1050;

/// Channel names of one to four channels: Y; Y, A; R, G, B; R, G, B, A.
std::vector<std::string> channel_names(int count);

/// Makes an image whose values are `value(i)`, with i over all of height x width x channels.
template <class Value>
Image make_image(int width, int height, int channels, bool srgb_encoded, const Value& value) {
  Image image;
  image.width = width, image.height = height;
  image.channels = channel_names(channels);
  image.srgb_encoded = srgb_encoded;
  image.pixels.resize(std::size_t(width) * height * channels);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = value(i);
  return image;
}

/// Returns a value in [0, 1] as an integer from 0 to the type's largest; NaN becomes 0.
template <class Integer>
Integer integer_value(float v) {
  return v >= 0 ? Integer(std::min(v, 1.f) * float(std::numeric_limits<Integer>::max()) + 0.5f) : Integer(0);
}

/// The order in which a file stores its pixels.
struct Orientation {
  bool transposed = false;   ///< whether stored lines are columns of the picture
  bool from_right = false;   ///< whether columns are stored from right to left
  bool from_bottom = false;  ///< whether rows are stored from bottom to top
};
/// Returns an image with rows from the top and columns from the left.
Image reoriented(Image image, const Orientation& stored);

Image read_exr(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels);
Image read_png(Bytes bytes, std::size_t max_pixels);
Image read_jpeg(Bytes bytes, std::size_t max_pixels);
Image read_tiff(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels);
Image read_pfm(Bytes bytes, std::size_t max_pixels);
Image read_hdr(Bytes bytes, std::size_t max_pixels);
/// Reads TGA or BMP. TGA has no signature, so files of unknown format are read here, too.
Image read_tga_bmp(Bytes bytes, std::size_t max_pixels);

std::vector<char> encode_exr(const Image& image, ExrPixel pixel, const ExrAttributes& attributes);
std::vector<char> encode_png(const Image& image, int bits);
std::vector<char> encode_jpeg(const Image& image, int quality);
std::vector<char> encode_tiff(const Image& image, TiffPixel pixel);
/// A raw picture as a TIFF of one channel, or as a DNG.
std::vector<char> encode_raw(const RawImage& raw, bool is_dng);
/// Encode images whose channels are exactly R, G, B or Y.
std::vector<char> encode_hdr(const Image& image);
std::vector<char> encode_pfm(const Image& image);

}  // namespace aureole::codec
