// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/memory.h"
#include "aureole/core/output_file.h"
#include "aureole/core/unfilled.h"

namespace aureole {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& message) {
  throw Error({file.string(), 0, 0}, message);
}

UnfilledVector<unsigned char> read_bytes(const std::filesystem::path& file) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 36;
  InputFile input(file);
  input.require_at_most(kMaxBytes);
  UnfilledVector<unsigned char> bytes(input.size());
  input.read(bytes.data(), bytes.size());
  return bytes;
}

bool starts_with(codec::Bytes bytes, std::string_view signature) {
  return bytes.size() >= signature.size() &&
         std::memcmp(bytes.data(), signature.data(), signature.size()) == 0;
}

enum class Format { exr, png, jpeg, tiff, pfm, hdr, unknown };

Format format_of(codec::Bytes b) {
  using namespace std::string_view_literals;
  if (starts_with(b, "\x76\x2f\x31\x01"sv)) return Format::exr;
  if (starts_with(b, "\x89PNG"sv)) return Format::png;
  if (starts_with(b, "\xff\xd8\xff"sv)) return Format::jpeg;
  for (const auto signature : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (starts_with(b, signature)) return Format::tiff;
  for (const auto signature : {"PF\n"sv, "Pf\n"sv, "PF\r"sv, "Pf\r"sv, "PF "sv, "Pf "sv})
    if (starts_with(b, signature)) return Format::pfm;
  return starts_with(b, "#?"sv) ? Format::hdr : Format::unknown;
}

Image decode(codec::Bytes b, ExrAttributes* attributes, std::size_t max_pixels) {
  if (b.empty()) throw Error("the file is empty");
  switch (format_of(b)) {
    case Format::exr:
      return codec::read_exr(b, attributes, max_pixels);
    case Format::png:
      return codec::read_png(b, max_pixels);
    case Format::jpeg:
      return codec::read_jpeg(b, max_pixels);
    case Format::tiff:
      return codec::read_tiff(b, attributes, max_pixels);
    case Format::pfm:
      return codec::read_pfm(b, max_pixels);
    case Format::hdr:
      return codec::read_hdr(b, max_pixels);
    case Format::unknown:
      break;
  }
  return codec::read_tga_bmp(b, max_pixels);
}

void convert_to_srgb(Image& image) {
  const int at[3] = {image.channel("R"), image.channel("G"), image.channel("B")};
  if (at[0] < 0 || at[1] < 0 || at[2] < 0) return;
  const std::array<float, 9>& m = image.conversion->to_srgb;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count()) {
    float* const p = &image.pixels[i];
    const float rgb[3] = {p[at[0]], p[at[1]], p[at[2]]};
    for (std::size_t k = 0; k < 3; ++k)
      p[at[k]] = m[3 * k] * rgb[0] + m[3 * k + 1] * rgb[1] + m[3 * k + 2] * rgb[2];
  }
  for (const std::string& note : image.conversion->notes) image.notes.push_back(note);
}

/// Writes the bytes that `encode` returns, and adds the file's name to its errors.
template <class Encode>
void write_encoded(const std::filesystem::path& file, const Encode& encode) {
  try {
    write_file_atomically(file, encode());
  } catch (const Error& e) {
    if (!e.where().file.empty()) throw;
    fail(file, e.message());
  }
}

}  // namespace

int Image::channel(const std::string& name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  return found == channels.end() ? -1 : int(found - channels.begin());
}

bool is_image_file(const std::filesystem::path& file) {
  InputFile input(file);
  unsigned char first[4] = {};
  input.read(first, std::min<std::uint64_t>(input.size(), sizeof first));
  const std::string extension = lower_extension(file);
  return format_of(first) != Format::unknown || extension == ".tga" || extension == ".bmp";
}

Image read_image(const std::filesystem::path& file, ExrAttributes* attributes, std::size_t max_pixels,
                 ImageColors colors) {
  try {
    const UnfilledVector<unsigned char> bytes = read_bytes(file);
    Image image = decode(bytes, attributes, max_pixels);
    if (image.conversion && colors == ImageColors::srgb) convert_to_srgb(image);
    if (!image.profile.empty() && colors == ImageColors::srgb)
      if (const std::string note = convert_from_profile(image, image.profile); !note.empty())
        image.notes.push_back(note);
    return image;
  } catch (const Error& e) {
    if (!e.where().file.empty()) throw;
    fail(file, e.message());
  } catch (const std::bad_alloc&) {
    fail(file, "not enough memory for this image");
  }
}

void write_exr(const std::filesystem::path& file, const Image& image, ExrPixel pixel,
               const ExrAttributes& attributes) {
  write_encoded(file, [&] { return codec::encode_exr(image, pixel, attributes); });
}

std::vector<char> encode_png(const Image& image, int bits) { return codec::encode_png(image, bits); }

void write_png(const std::filesystem::path& file, const Image& image, int bits) {
  write_encoded(file, [&] { return codec::encode_png(image, bits); });
}

void write_jpeg(const std::filesystem::path& file, const Image& image, int quality) {
  write_encoded(file, [&] { return codec::encode_jpeg(image, quality); });
}

void write_tiff(const std::filesystem::path& file, const Image& image, TiffPixel pixel) {
  write_encoded(file, [&] { return codec::encode_tiff(image, pixel); });
}

void write_raw_tiff(const std::filesystem::path& file, const RawImage& raw) {
  write_encoded(file, [&] { return codec::encode_raw(raw, false); });
}

void write_dng(const std::filesystem::path& file, const RawImage& raw) {
  write_encoded(file, [&] { return codec::encode_raw(raw, true); });
}

void write_hdr(const std::filesystem::path& file, const Image& image) {
  write_encoded(file, [&] { return codec::encode_hdr(image); });
}

void write_pfm(const std::filesystem::path& file, const Image& image) {
  write_encoded(file, [&] { return codec::encode_pfm(image); });
}

float srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

namespace codec {

void check_size(long long width, long long height, double channels, std::size_t max_pixels,
                std::size_t file_bytes, double most_per_byte) {
  if (width <= 0 || height <= 0) throw Error("the image has no pixels");
  const double pixels = double(width) * double(height);
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (pixels > double(max_pixels))
    throw Error(size + " are more than the limit of " + std::to_string(max_pixels));
  if (pixels > most_per_byte * (double(file_bytes) + 64))
    throw Error("the file is truncated or damaged: " + size + " cannot be in " + std::to_string(file_bytes) +
                " bytes");
  require_content(pixels * channels * sizeof(float), double(file_bytes), kPixelBytesPerByte);
}

std::vector<std::string> channel_names(int count) {
  switch (count) {
    case 1:
      return {"Y"};
    case 2:
      return {"Y", "A"};
    case 3:
      return {"R", "G", "B"};
    default:
      return {"R", "G", "B", "A"};
  }
}

Image reoriented(Image image, const Orientation& o) {
  if (!o.transposed && !o.from_right && !o.from_bottom) return image;
  const std::size_t channels = image.channel_count(), columns = std::size_t(image.width);
  std::vector<float> stored(image.pixels.size());
  stored.swap(image.pixels);
  if (o.transposed) std::swap(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::size_t u = std::size_t(o.from_right ? image.width - 1 - x : x),
                        v = std::size_t(o.from_bottom ? image.height - 1 - y : y);
      const std::size_t from = o.transposed ? u * columns + v : v * columns + u;
      std::copy_n(
          stored.begin() + std::ptrdiff_t(from * channels), channels,
          image.pixels.begin() +
              std::ptrdiff_t((std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * channels));
    }
  return image;
}

}  // namespace codec

}  // namespace aureole
