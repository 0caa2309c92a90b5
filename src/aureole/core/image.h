// SPDX-License-Identifier: Apache-2.0
// Reads and writes images; only this module uses the image libraries. Pixels are float, row by row from the
// top.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace aureole {

/// A change of colour space that an image file requests.
struct ColorConversion {
  std::array<float, 9> to_srgb;  ///< rows of the matrix from the stored R, G, B to linear sRGB
  std::vector<std::string> notes;
};

/// An image with named float channels. The channels are in the file's order (or R, G, B[, A] or Y for the 8-
/// and 16-bit formats).
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;  ///< height x width x channels
  bool srgb_encoded = false;  ///< whether values in [0, 1] are sRGB-encoded (8- and 16-bit formats)
  bool cube_map = false;      ///< whether the image is six faces one above the other (EXR attribute `envmap`)
  /// Set where the file states other primaries or an exposure. `read_image` applies it and adds its notes to
  /// the image's, unless the caller requests stored values.
  std::optional<ColorConversion> conversion{};
  /// The ICC profile in the file, or one of the primaries and the transfer function that a PNG states. `read_image`
  /// converts the colours to sRGB, with a note, unless the caller requests stored values.
  std::vector<unsigned char> profile{};
  /// Assumptions made on reading the file, such as "the first of 12 pages is read".
  std::vector<std::string> notes{};
  std::string format{};     ///< format of the file that was read, such as "PNG, 8 bits per channel"
  std::string primaries{};  ///< primaries that the file states, in words; empty if it states none

  std::size_t channel_count() const { return channels.size(); }
  float& at(int x, int y, std::size_t c) {
    return pixels[(std::size_t(y) * width + x) * channels.size() + c];
  }
  float at(int x, int y, std::size_t c) const {
    return pixels[(std::size_t(y) * width + x) * channels.size() + c];
  }
  /// Returns the index of a channel, or -1.
  int channel(const std::string& name) const;
};

/// Metadata of an EXR file: string, integer and float attributes, written with their own EXR types. Reading a
/// TIFF sets "ImageDescription", "XResolution", "YResolution" and "ResolutionUnit" if present.
struct ExrAttributes {
  std::map<std::string, std::string> strings;
  std::map<std::string, int> integers;
  std::map<std::string, float> floats;
};

/// Colours are converted to linear sRGB where a file states other primaries or an exposure, or read as they
/// are stored (heights, normals).
enum class ImageColors { srgb, stored };

/// Reads EXR, PNG, JPEG, TIFF, PFM, HDR, TGA or BMP; the content determines the format. Throws Error that
/// names the file and the problem (missing, truncated, unknown format, more than `max_pixels`).
Image read_image(const std::filesystem::path& file, ExrAttributes* attributes = nullptr,
                 std::size_t max_pixels = std::size_t(1) << 30, ImageColors colors = ImageColors::srgb);

/// Returns whether the content of a file begins like an image; TGA, which has no signature, and BMP are
/// recognised by their extension. Throws Error if the file cannot be read.
bool is_image_file(const std::filesystem::path& file);

enum class ExrPixel { half, float32 };

/// Writes scan-line EXR (ZIP compression). R, G, B channels get the chromaticities of sRGB. The write is
/// atomic: a temporary file beside `file` is renamed.
void write_exr(const std::filesystem::path& file, const Image& image, ExrPixel pixel,
               const ExrAttributes& attributes);

/// Writes a PNG of 8 or 16 bits with one to four channels, whose values in [0, 1] are already encoded for display,
/// marked as sRGB. The write is atomic.
void write_png(const std::filesystem::path& file, const Image& image, int bits = 8);

/// Returns the content of the file that `write_png` writes.
std::vector<char> encode_png(const Image& image, int bits = 8);

/// Writes a JPEG (R, G, B or Y, values in [0, 1] encoded for display) with the profile of sRGB. `quality` is from 1 to
/// 100; from 90 on colours have full resolution. The write is atomic.
void write_jpeg(const std::filesystem::path& file, const Image& image, int quality = 95);

enum class TiffPixel { integer8, integer16, float32 };

/// Writes a TIFF (deflate) with channels Y or R, G, B and perhaps A, and the profile of sRGB: integers of values in [0, 1]
/// that are encoded for display, or linear floats. Alpha is multiplied into floats (associated) and not into integers. The
/// write is atomic.
void write_tiff(const std::filesystem::path& file, const Image& image, TiffPixel pixel);

/// Writes R, G, B (or Y as grey) in Radiance's RGBE format: 8-bit mantissas with a common exponent. Negative
/// values become 0. The write is atomic.
void write_hdr(const std::filesystem::path& file, const Image& image);

/// Writes R, G, B or Y as a portable float map. The write is atomic.
void write_pfm(const std::filesystem::path& file, const Image& image);

/// The sRGB transfer function and its inverse (IEC 61966-2-1).
float srgb_encode(float linear);
float srgb_decode(float encoded);

}  // namespace aureole
