// SPDX-License-Identifier: Apache-2.0
// Reading and writing images: the one place that knows the image libraries. Pixels are float, row by row from
// the top.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace aureole {

/// Named float channels of one size. Channel order is as in the file (or R, G, B[, A] or Y for the 8- and
/// 16-bit formats).
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;  ///< height x width x channels
  bool srgb_encoded = false;  ///< values are gamma-encoded (8- and 16-bit formats), scaled to [0, 1]

  std::size_t channel_count() const { return channels.size(); }
  float& at(int x, int y, std::size_t c) {
    return pixels[(std::size_t(y) * width + x) * channels.size() + c];
  }
  float at(int x, int y, std::size_t c) const {
    return pixels[(std::size_t(y) * width + x) * channels.size() + c];
  }
  /// Index of a channel, or -1.
  int channel(const std::string& name) const;
};

/// Metadata of an EXR file: string, integer and float attributes; numbers are written as their own EXR types.
/// A TIFF that is read has "ImageDescription", "XResolution", "YResolution" and "ResolutionUnit" where
/// present.
struct ExrAttributes {
  std::map<std::string, std::string> strings;
  std::map<std::string, int> integers;
  std::map<std::string, float> floats;
};

/// Reads EXR, PNG, JPEG, TIFF, PFM, HDR, TGA or BMP, by content. Throws Error that names the file and the
/// fault (missing, truncated, unknown format, more than `max_pixels`).
Image read_image(const std::filesystem::path& file, ExrAttributes* attributes = nullptr,
                 std::size_t max_pixels = std::size_t(1) << 30);

enum class ExrPixel { half, float32 };

/// Writes scan-line EXR (ZIP). R, G, B channels get the chromaticities of sRGB. Atomic: written beside
/// `file`, then renamed.
void write_exr(const std::filesystem::path& file, const Image& image, ExrPixel pixel,
               const ExrAttributes& attributes);

/// Writes an 8-bit PNG of one, three or four channels given as values already encoded for display in [0, 1].
/// Atomic.
void write_png(const std::filesystem::path& file, const Image& image);

/// The bytes of that file.
std::vector<char> encode_png(const Image& image);

/// Writes R, G, B (or Y as grey) in Radiance's RGBE format: 8 bits with a common exponent, nothing negative.
/// Atomic.
void write_hdr(const std::filesystem::path& file, const Image& image);

/// Writes R, G, B or Y as a portable float map. Atomic.
void write_pfm(const std::filesystem::path& file, const Image& image);

/// The sRGB transfer function and its inverse (IEC 61966-2-1).
float srgb_encode(float linear);
float srgb_decode(float encoded);

/// Replaces `file` by `bytes` atomically (write, flush, rename). Throws Error.
void write_file_atomically(const std::filesystem::path& file, std::span<const char> bytes);

}  // namespace aureole
