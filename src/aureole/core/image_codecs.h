// SPDX-License-Identifier: Apache-2.0
// One function per image format, used by image.cpp alone. They read from memory and throw Error without the
// file's name.
#pragma once

#include <cstddef>
#include <span>

#include "aureole/core/image.h"

namespace aureole::codec {

using Bytes = std::span<const unsigned char>;

/// Throws Error unless width x height is positive, at most max_pixels, and at most `most_per_byte` pixels for
/// every byte of the file: a damaged header must not ask for memory that no file of this size can fill.
void check_size(long long width, long long height, std::size_t max_pixels, std::size_t file_bytes,
                double most_per_byte);

/// Channel names of one to four channels: Y; Y, A; R, G, B; R, G, B, A.
std::vector<std::string> channel_names(int count);

/// An image of the given size whose pixels come from `value(i)` over all of height x width x channels.
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

Image read_exr(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels);
Image read_png(Bytes bytes, std::size_t max_pixels);
Image read_jpeg(Bytes bytes, std::size_t max_pixels);
Image read_tiff(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels);
Image read_pfm(Bytes bytes, std::size_t max_pixels);
/// HDR, TGA or BMP; TGA has no signature, so that anything unknown ends here.
Image read_hdr_tga_bmp(Bytes bytes, std::size_t max_pixels);

std::vector<char> encode_exr(const Image& image, ExrPixel pixel, const ExrAttributes& attributes);
std::vector<char> encode_png(const Image& image);
/// Take images of exactly R, G, B or Y.
std::vector<char> encode_hdr(const Image& image);
std::vector<char> encode_pfm(const Image& image);

}  // namespace aureole::codec
