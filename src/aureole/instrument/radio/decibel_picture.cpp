// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/radio/power_map.h"
#include "aureole/instrument/report/false_color.h"

namespace aureole {

namespace {

double contours(const DecibelScale& scale) {
  const double range = scale.max_db - scale.min_db;
  return range > 30 ? 10 : range > 12 ? 5 : 2;
}

}  // namespace

DecibelScale DecibelScale::of(const std::vector<double>& values, std::string title) {
  std::vector<double> finite;
  for (const double v : values)
    if (std::isfinite(v)) finite.push_back(v);
  DecibelScale scale{-60, 0, 10, std::move(title)};
  if (finite.empty()) return scale;
  std::sort(finite.begin(), finite.end());
  const auto quantile = [&](double q) { return finite[std::size_t(q * double(finite.size() - 1))]; };
  scale.max_db = 5 * std::ceil(quantile(0.99) / 5);
  scale.min_db = std::max(5 * std::floor(quantile(0.01) / 5), scale.max_db - 60);
  if (scale.max_db - scale.min_db < kNarrowest) scale.min_db = scale.max_db - kNarrowest;
  scale.contour_db = contours(scale);
  return scale;
}

void DecibelScale::set_ends(std::optional<double> min, std::optional<double> max) {
  if (min) min_db = *min, max_db = std::clamp(max_db, *min + kNarrowest, *min + kWidest);
  if (max) max_db = *max;
  if (max && !min) min_db = std::clamp(min_db, *max - kWidest, *max - kNarrowest);
  contour_db = contours(*this);
}

Image decibel_picture(const std::vector<double>& values, int width, int height, const DecibelScale& scale) {
  // The range is bounded, since it determines the number of contours, which are drawn one by one.
  if (!(scale.max_db > scale.min_db && scale.max_db - scale.min_db <= DecibelScale::kWidest &&
        std::abs(scale.max_db) < 1e6))
    throw Error(fmt::format("no colours from {} to {} dB: they rise, by {} dB at most", scale.min_db,
                            scale.max_db, DecibelScale::kWidest));
  ColorScale colors{.low = scale.min_db, .high = scale.max_db, .title = scale.title};
  for (double level = scale.contour_db * std::ceil(scale.min_db / scale.contour_db); level <= scale.max_db;
       level += scale.contour_db)
    colors.contours.push_back(level);
  return false_color_picture(values, width, height, colors);
}

}  // namespace aureole
