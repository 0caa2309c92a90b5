// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/image_parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "aureole/core/parallel.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/value_limit.h"

namespace aureole {

namespace {

std::string shape_text(const Array& array) {
  std::string text;
  for (const std::size_t n : array.shape()) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text.empty() ? "one number" : text;
}

Image image_of(const Properties& p, const Array& array, std::size_t max_pixels) {
  const std::vector<std::size_t>& shape = array.shape();
  const std::size_t channels = shape.size() == 3 ? shape[2] : 1;
  if ((shape.size() != 2 && shape.size() != 3) || (channels != 1 && channels != 3 && channels != 4) ||
      array.values().empty())
    throw p.error("data",
                  "expected height x width numbers, or 1, 3 or 4 for each pixel, got " + shape_text(array));
  constexpr std::size_t kLongest = 1 << 24;
  if (shape[0] > kLongest || shape[1] > kLongest || shape[0] * shape[1] > max_pixels)
    throw p.error("data", "too many pixels: " + shape_text(array));
  Image image;
  image.height = int(shape[0]), image.width = int(shape[1]);
  image.channels = channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  if (channels == 4) image.channels.push_back("A");
  image.pixels.assign(array.values().begin(), array.values().end());
  return image;
}

}  // namespace

ImageParameter read_image_parameter(const Properties& p, ImageColors colors, std::size_t max_pixels) {
  const auto data = p.get_object<Array>("data");
  if (data && p.has("filename")) throw p.error("data", "give either filename or data");
  if (data) return {image_of(p, *data, max_pixels), "data"};
  const std::filesystem::path file = p.get_file("filename");
  try {
    Image image = read_image(file, nullptr, max_pixels, colors);
    for (const std::string& note : image.notes) p.note("filename", note);
    return {std::move(image), "filename"};
  } catch (const Error& problem) {
    throw p.error("filename", problem.what());
  }
}

/// Negative values count as artefacts, of resampling or of colours outside sRGB, if their sum is less than
/// this fraction of the positive values.
constexpr double kNegativePart = 0.1;

namespace {

struct PixelStatistics {
  float largest = 0;            ///< largest magnitude
  double above = 0, below = 0;  ///< sums of the magnitudes of positive and of negative values
  bool all_finite = true;
};

/// Returns the statistics of the finite values of some channels. Rows are summed one by one, so that the sums
/// do not depend on the threads.
PixelStatistics statistics_of(const Image& image, const std::vector<std::size_t>& used) {
  const std::size_t channels = image.channel_count(), row = std::size_t(image.width) * channels;
  std::vector<PixelStatistics> rows(std::size_t(image.height));
  for_rows(image.width, image.height, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      PixelStatistics s;
      for (const std::size_t c : used)
        for (std::size_t i = y * row + c; i < (y + 1) * row; i += channels) {
          const float size = std::abs(image.pixels[i]);
          if (!std::isfinite(size)) {
            s.all_finite = false;
            continue;
          }
          s.largest = std::max(s.largest, size);
          (image.pixels[i] < 0 ? s.below : s.above) += double(size);
        }
      rows[y] = s;
    }
  });
  PixelStatistics all;
  for (const PixelStatistics& s : rows) {
    all.largest = std::max(all.largest, s.largest);
    all.above += s.above, all.below += s.below;
    all.all_finite &= s.all_finite;
  }
  return all;
}

}  // namespace

bool mend_pixels(const Properties& p, std::string_view name, Image& image, PixelRange range) {
  const std::size_t channels = image.channel_count(), pixels = image.pixels.size() / channels;
  std::vector<std::size_t> used;
  for (const char* channel : {"R", "G", "B", "Y"})
    if (const int c = image.channel(channel); c >= 0) used.push_back(std::size_t(c));
  if (used.empty()) used.push_back(0);
  const auto place = [&](std::size_t pixel) {
    return fmt::format("column {}, row {}", pixel % std::size_t(image.width),
                       pixel / std::size_t(image.width));
  };
  const auto [largest, above, below, all_finite] = statistics_of(image, used);
  if (all_finite && (below == 0 || range == PixelRange::any)) return below > 0;
  std::size_t bad = 0, first_bad = 0, negative = 0, first_negative = 0;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  NoiseClamp clamp(range == PixelRange::any ? -kNone : 0, kNone, largest);
  const bool cuts = range == PixelRange::radiance || (range == PixelRange::not_negative &&
                                                      (image.conversion || below <= kNegativePart * above));
  for (std::size_t i = 0; i < pixels; ++i) {
    bool finite = true;
    for (const std::size_t c : used) {
      float& v = image.pixels[i * channels + c];
      if (!std::isfinite(v)) {
        finite = false;
        v = std::isnan(v) ? 0 : std::copysign(largest, v);
      }
      v = clamp(v);
      if (v < 0 && cuts) {
        if (negative++ == 0) first_negative = i;
        v = 0;
      }
    }
    if (!finite && bad++ == 0) first_bad = i;
  }
  if (bad > std::max<std::size_t>(1, pixels / 100))
    throw p.error(name, fmt::format("{} of {} pixels are NaN or infinite, the first at {}", bad, pixels,
                                    place(first_bad)));
  if (bad > 0)
    p.note(name, fmt::format("{} of {} pixels {} NaN or infinite, the first at {}: NaN counts as 0, infinity "
                             "as the largest value",
                             bad, pixels, bad == 1 ? "is" : "are", place(first_bad)));
  if (negative > 0)
    p.note(name, fmt::format("{} negative values of the picture, the first at {}, count as 0", negative,
                             place(first_negative)));
  if (clamp.any()) p.note(name, clamp.note());
  return below > 0 && !cuts;
}

ParameterDoc image_file_doc(const std::string& meaning) {
  return {"filename", "file", "", "required, or data", meaning};
}

ParameterDoc image_data_doc() {
  return {"data", "array", "", "none",
          "instead of filename, from Python: an array of linear values, height x width [x 1, 3 or 4]"};
}

}  // namespace aureole
