// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/picture/convert_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/render/state.h"
#include "aureole/render/statistics.h"

namespace aureole {
namespace {

enum class Format { exr, hdr, pfm, png, jpeg, tiff };

Format format_called(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".exr") return Format::exr;
  if (extension == ".hdr" || extension == ".rgbe" || extension == ".pic") return Format::hdr;
  if (extension == ".pfm") return Format::pfm;
  if (extension == ".png") return Format::png;
  if (extension == ".jpg" || extension == ".jpeg") return Format::jpeg;
  if (extension == ".tif" || extension == ".tiff") return Format::tiff;
  throw Error({file.string(), 0, 0},
              "the extension \"" + extension +
                  "\" is none of a picture's: .exr, .hdr, .pfm, .png, .jpg or .tif is expected");
}

bool is_color(const std::string& channel) {
  return channel == "R" || channel == "G" || channel == "B" || channel == "Y";
}

/// Reads a picture as linear values with alpha multiplied into the colours.
Image read_linear(const std::filesystem::path& file, ExrAttributes& attributes,
                  std::vector<std::string>& notes) {
  Image image = read_image(file, &attributes);
  for (const std::string& note : image.notes) notes.push_back(file.string() + ": " + note);
  if (!image.srgb_encoded) return image;
  const int alpha = image.channel("A");
  const std::size_t channels = image.channel_count();
  for (std::size_t i = 0; i < image.pixels.size(); i += channels) {
    const float a = alpha < 0 ? 1 : image.pixels[i + std::size_t(alpha)];
    for (std::size_t c = 0; c < channels; ++c)
      if (int(c) != alpha) image.pixels[i + c] = a * srgb_decode(image.pixels[i + c]);
  }
  image.srgb_encoded = false;
  return image;
}

/// The channels of `indices`, with new names.
Image with_channels(const Image& image, const std::vector<std::size_t>& indices,
                    std::vector<std::string> names) {
  Image out{image.width, image.height, std::move(names), {}};
  out.pixels.reserve(std::size_t(image.width) * std::size_t(image.height) * indices.size());
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count())
    for (const std::size_t c : indices) out.pixels.push_back(image.pixels[i + c]);
  return out;
}

/// All channels but alpha, at index `alpha`.
Image without_channel(const Image& image, int alpha) {
  std::vector<std::size_t> indices;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < image.channel_count(); ++c)
    if (int(c) != alpha) indices.push_back(c), names.push_back(image.channels[c]);
  return with_channels(image, indices, names);
}

[[noreturn]] void no_channel(const std::filesystem::path& file, const std::string& wanted,
                             const Image& image) {
  throw Error({file.string(), 0, 0},
              fmt::format("there is no channel {}; there are {}", wanted, fmt::join(image.channels, ", ")));
}

/// The layer or channel of a name; for an empty name the colours with alpha.
Image selected(const Image& image, const std::string& name, const std::filesystem::path& file) {
  const std::string prefix = name.empty() ? "" : name + ".";
  std::vector<std::size_t> indices;
  std::vector<std::string> names;
  const auto add = [&](const std::string& part) {
    const int c = image.channel(prefix + part);
    if (c >= 0) indices.push_back(std::size_t(c)), names.push_back(part);
    return c >= 0;
  };
  if (!(add("R") && add("G") && add("B"))) {
    indices.clear(), names.clear();
    add("Y");
  }
  if (!indices.empty()) {
    add("A");
    return with_channels(image, indices, names);
  }
  if (const int c = image.channel(name); c >= 0 && !name.empty())
    return with_channels(image, {std::size_t(c)}, {"Y"});
  if (name.empty() && image.channel_count() == 1) return with_channels(image, {0}, {"Y"});
  no_channel(file, name.empty() ? "R, G, B or Y" : name, image);
}

void subtract(Image& a, const Image& b, PictureDifference kind, const std::filesystem::path& file,
              std::vector<std::string>& notes) {
  if (a.width != b.width || a.height != b.height)
    throw Error({file.string(), 0, 0}, fmt::format("has {} x {} pixels, and the other picture {} x {}",
                                                   b.width, b.height, a.width, a.height));
  std::vector<std::size_t> indices, others;
  std::vector<std::string> names;
  std::string left_out;
  for (std::size_t c = 0; c < a.channel_count(); ++c) {
    const std::string& name = a.channels[c];
    const int other = b.channel(name);
    const bool is_alpha = name == "A" || name.ends_with(".A");
    if (other >= 0 && !is_alpha)
      indices.push_back(c), others.push_back(std::size_t(other)), names.push_back(name);
    else if (!is_alpha)
      left_out += (left_out.empty() ? "" : ", ") + name;
  }
  if (indices.empty()) no_channel(file, fmt::format("{}", fmt::join(a.channels, ", ")), b);
  if (!left_out.empty()) notes.push_back(file.string() + ": has no channel " + left_out + ", left out");
  Image out = with_channels(a, indices, names);
  const std::size_t pixels = std::size_t(a.width) * std::size_t(a.height);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < indices.size(); ++c) {
      float& value = out.pixels[i * indices.size() + c];
      const float before = b.pixels[i * b.channel_count() + others[c]];
      value -= before;
      if (kind == PictureDifference::absolute) value = std::abs(value);
      if (kind == PictureDifference::relative) value = value == 0 ? 0 : value / before;
    }
  a = std::move(out);
}

void crop(Image& image, const std::array<int, 4>& window, const std::filesystem::path& file) {
  const auto [x, y, width, height] = window;
  if (x < 0 || y < 0 || width < 1 || height < 1 || x > image.width - width || y > image.height - height)
    throw Error({file.string(), 0, 0},
                fmt::format("the crop {},{},{},{} (x, y, width, height) is not inside {} x {} pixels", x, y,
                            width, height, image.width, image.height));
  std::vector<float> pixels;
  const std::size_t channels = image.channel_count();
  pixels.reserve(std::size_t(width) * std::size_t(height) * channels);
  for (int row = y; row < y + height; ++row) {
    const auto first =
        image.pixels.begin() +
        std::ptrdiff_t((std::size_t(row) * std::size_t(image.width) + std::size_t(x)) * channels);
    pixels.insert(pixels.end(), first, first + std::ptrdiff_t(std::size_t(width) * channels));
  }
  image.pixels = std::move(pixels), image.width = width, image.height = height;
}

/// One number for each pixel: the luminance of R, G, B (ITU-R BT.709), or Y.
std::vector<double> luminances(const Image& image) {
  const int r = image.channel("R"), y = image.channel("Y");
  std::vector<double> values;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count()) {
    const float* p = &image.pixels[i];
    values.push_back(r < 0 ? double(p[std::size_t(std::max(y, 0))])
                           : 0.2126 * p[std::size_t(r)] + 0.7152 * p[std::size_t(image.channel("G"))] +
                                 0.0722 * p[std::size_t(image.channel("B"))]);
  }
  return values;
}

Image in_false_colors(const Image& image, const ConvertSettings& s, const std::string& title,
                      std::vector<std::string>& notes) {
  const std::vector<double> values = luminances(image);
  ColorScale scale{.is_logarithmic = s.is_logarithmic, .map = s.map, .title = title};
  double low = HUGE_VAL, high = -HUGE_VAL;
  std::size_t none = 0;
  for (const double v : values) {
    const bool counts = std::isfinite(v) && (v > 0 || !s.is_logarithmic);
    none += !counts;
    if (counts) low = std::min(low, v), high = std::max(high, v);
  }
  if (none == values.size() && !(s.low && s.high))
    throw Error(s.is_logarithmic ? "no value is above 0: a logarithmic scale has no ends"
                                 : "no value is finite");
  if (none > 0)
    notes.push_back(fmt::format("{} of {} pixels are {} and dark grey", none, values.size(),
                                s.is_logarithmic ? "not above 0" : "not finite"));
  if (!(high > low)) high = low + (low != 0 ? std::abs(low) : 1);
  scale.low = s.low.value_or(low), scale.high = s.high.value_or(high);
  for (int i = 1; i <= s.contours; ++i) {
    const double t = double(i) / (s.contours + 1);
    scale.contours.push_back(s.is_logarithmic ? scale.low * std::pow(scale.high / scale.low, t)
                                              : scale.low + t * (scale.high - scale.low));
  }
  return false_color_picture(values, image.width, image.height, scale);
}

/// Colours encoded for display, with alpha that is not multiplied into them.
Image encoded(const Image& image, const std::optional<Tone>& tone) {
  Image colors = image;
  const int alpha = image.channel("A");
  if (alpha >= 0) {
    colors = without_channel(image, alpha);
    for (std::size_t i = 0; i < colors.pixels.size(); ++i) {
      const float a = image.pixels[i / colors.channel_count() * image.channel_count() + std::size_t(alpha)];
      if (a > 0) colors.pixels[i] /= a;
    }
  }
  if (tone) {
    const bool is_grey = colors.channel("R") < 0;
    colors = toned(colors, *tone);
    if (is_grey) colors = with_channels(colors, {0}, {"Y"});
  } else {
    colors = display_picture(colors);
  }
  if (alpha < 0) return colors;
  Image out{image.width, image.height, colors.channels, {}, true};
  out.channels.emplace_back("A");
  const std::size_t count = colors.channel_count();
  for (std::size_t i = 0; i < colors.pixels.size(); i += count) {
    out.pixels.insert(out.pixels.end(), &colors.pixels[i], &colors.pixels[i] + count);
    out.pixels.push_back(image.pixels[i / count * image.channel_count() + std::size_t(alpha)]);
  }
  return out;
}

Image without_alpha(const Image& image, std::vector<std::string>& notes, const char* format) {
  const int alpha = image.channel("A");
  if (alpha < 0) return image;
  notes.push_back(fmt::format("a {} has no alpha: the picture is over black", format));
  return without_channel(image, alpha);
}

void check_bits(Format format, int bits, const std::filesystem::path& output) {
  const std::vector<int> possible = format == Format::png    ? std::vector{8, 16}
                                    : format == Format::tiff ? std::vector{8, 16, 32}
                                    : format == Format::exr  ? std::vector{16, 32}
                                    : format == Format::jpeg ? std::vector{8}
                                                             : std::vector{32};
  if (bits != 0 && std::find(possible.begin(), possible.end(), bits) == possible.end())
    throw Error({output.string(), 0, 0}, fmt::format("this format has {} bits per channel, not {}",
                                                     fmt::join(possible, " or "), bits));
}

std::string edits_of(const ConvertSettings& s) {
  std::vector<std::string> edits;
  if (!s.subtrahend.empty())
    edits.push_back(fmt::format("{} {}",
                                s.difference == PictureDifference::plain      ? "minus"
                                : s.difference == PictureDifference::absolute ? "absolute difference to"
                                                                              : "relative difference to",
                                s.subtrahend.filename().string()));
  if (!s.channel.empty()) edits.push_back("channel " + s.channel);
  if (s.crop) edits.push_back(fmt::format("crop {}", fmt::join(*s.crop, ",")));
  if (s.exposure != 0) edits.push_back(fmt::format("exposure {:+g}", s.exposure));
  return fmt::format("{}", fmt::join(edits, "; "));
}

}  // namespace

Converted convert_picture(const std::filesystem::path& file, const std::filesystem::path& output,
                          const ConvertSettings& s) {
  const Format format = format_called(output);
  check_bits(format, s.bits, output);
  if (!s.is_false_color && (s.low || s.high || s.is_logarithmic || s.contours > 0))
    throw Error("low, high, a logarithmic scale and contours are for false colours");
  if (s.is_false_color && s.tone) throw Error("false colours have a scale and no tone mapping");
  require_writable(output);
  Converted result;
  ExrAttributes attributes, others;
  Image image = read_linear(file, attributes, result.notes);
  if (!s.subtrahend.empty())
    subtract(image, read_linear(s.subtrahend, others, result.notes), s.difference, s.subtrahend,
             result.notes);
  const bool is_linear = format == Format::exr || format == Format::hdr || format == Format::pfm ||
                         (format == Format::tiff && s.bits == 32);
  const bool keeps_all = format == Format::exr && s.channel.empty() && !s.is_false_color;
  if (!keeps_all) image = selected(image, s.channel, file);
  if (s.crop) crop(image, *s.crop, file);
  if (s.exposure != 0) {
    const float gain = float(std::exp2(s.exposure));
    std::vector<bool> is_scaled;
    std::string left;
    for (const std::string& name : image.channels) {
      is_scaled.push_back(is_color(name));
      if (!is_scaled.back() && name != "A") left += (left.empty() ? "" : ", ") + name;
    }
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      if (is_scaled[i % image.channel_count()]) image.pixels[i] *= gain;
    if (!left.empty()) result.notes.push_back("the exposure changes R, G, B and Y, not " + left);
  }

  if (s.is_false_color) {
    const std::string of = s.channel.empty() ? "luminance" : s.channel;
    image = in_false_colors(image, s, file.filename().string() + ", " + of, result.notes);
    if (is_linear) {
      for (float& v : image.pixels) v = srgb_decode(v);
      image.srgb_encoded = false;
    }
  } else if (is_linear) {
    if (s.tone) throw Error({output.string(), 0, 0}, "tone mapping is for integers: .png, .jpg, .tif");
  } else {
    image = encoded(image, s.tone);
  }

  const auto colors_alone = [&](const char* name) { return without_alpha(image, result.notes, name); };
  switch (format) {
    case Format::exr:
      if (!keeps_all) attributes.strings.erase("aureole:channels");
      if (const std::string edits = edits_of(s); !edits.empty()) {
        std::string& all = attributes.strings["aureole:edits"];
        all += (all.empty() ? "" : "; ") + edits;
      }
      write_exr(output, image, s.bits == 16 ? ExrPixel::half : ExrPixel::float32, attributes);
      break;
    case Format::hdr:
      image = colors_alone("Radiance picture"), write_hdr(output, image);
      break;
    case Format::pfm:
      image = colors_alone("PFM"), write_pfm(output, image);
      break;
    case Format::png:
      write_png(output, image, s.bits == 0 ? 8 : s.bits);
      break;
    case Format::jpeg:
      if (image.channel("A") >= 0) {
        // Undoes the division by alpha: the colours over black are multiplied by alpha.
        const std::size_t channels = image.channel_count(), alpha = std::size_t(image.channel("A"));
        for (std::size_t i = 0; i < image.pixels.size(); i += channels)
          for (std::size_t c = 0; c < channels; ++c)
            if (c != alpha)
              image.pixels[i + c] = srgb_encode(image.pixels[i + alpha] * srgb_decode(image.pixels[i + c]));
        image = colors_alone("JPEG");
      }
      write_jpeg(output, image, s.quality);
      break;
    case Format::tiff:
      write_tiff(output, image,
                 s.bits == 8    ? TiffPixel::integer8
                 : s.bits == 32 ? TiffPixel::float32
                                : TiffPixel::integer16);
      break;
  }
  result.width = image.width, result.height = image.height, result.channels = image.channels;
  return result;
}

}  // namespace aureole
