// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "aureole/core/error.h"
#include "aureole/instrument/radio/power_map.h"
#include "aureole/instrument/report/svg_plot.h"

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

namespace {

/// The median of the finite values among the 3 x 3 cells around each cell; without it, contours would follow
/// the noise.
std::vector<double> without_outliers(const std::vector<double>& values, int width, int height) {
  std::vector<double> result(values.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double around[9];
      int count = 0;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width - 1); ++i) {
          const double v = values[std::size_t(j) * std::size_t(width) + std::size_t(i)];
          if (std::isfinite(v)) around[count++] = v;
        }
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      std::nth_element(around, around + count / 2, around + count);
      result[at] = std::isfinite(values[at]) ? around[count / 2] : values[at];
    }
  return result;
}

/// Draws contour lines between the centres of cells, by marching squares; `zoom` is in pixels per cell.
void draw_contours(cv::Mat& picture, const std::vector<double>& values, int width, int height, int zoom,
                   double level) {
  constexpr int kFine = 16;  // sixteenths of a pixel
  const auto at = [&](int x, int y) { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; };
  const auto to = [&](double x, double y) {
    return cv::Point(int((x + 0.5) * zoom * kFine), int((y + 0.5) * zoom * kFine));
  };
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      const double corner[4] = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
      if (!std::all_of(corner, corner + 4, [](double v) { return std::isfinite(v); })) continue;
      constexpr int kX[] = {0, 1, 1, 0, 0}, kY[] = {0, 0, 1, 1, 0};
      cv::Point crossings[4];
      int count = 0;
      for (int k = 0; k < 4; ++k) {
        const double a = corner[k] - level, b = corner[(k + 1) % 4] - level;
        if ((a < 0) == (b < 0)) continue;
        const double t = a / (a - b);
        crossings[count++] = to(x + kX[k] + (kX[k + 1] - kX[k]) * t, y + kY[k] + (kY[k + 1] - kY[k]) * t);
      }
      for (int k = 0; k + 1 < count; k += 2)
        cv::line(picture, crossings[k], crossings[k + 1], cv::Scalar(255, 255, 255), 1, cv::LINE_AA, 4);
    }
}

}  // namespace

Image decibel_picture(const std::vector<double>& values, int width, int height, const DecibelScale& scale) {
  // Bounds the number of contours, which are drawn one by one.
  if (!(scale.max_db > scale.min_db && scale.max_db - scale.min_db <= DecibelScale::kWidest &&
        std::abs(scale.max_db) < 1e6))
    throw Error(fmt::format("no colours from {} to {} dB: they rise, by {} dB at most", scale.min_db,
                            scale.max_db, DecibelScale::kWidest));
  const int zoom = std::max(1, 640 / std::max(width, height));
  const int map_width = width * zoom, map_height = std::max(height * zoom, 160);
  constexpr int kGap = 14, kBar = 18, kLabels = 58, kTop = 26;
  cv::Mat picture(map_height + kTop + kGap, map_width + 2 * kGap + kBar + kLabels, CV_8UC3,
                  cv::Scalar(255, 255, 255));

  cv::Mat ramp(1, 256, CV_8UC1), colours;
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = std::uint8_t(i);
  cv::applyColorMap(ramp, colours, cv::COLORMAP_VIRIDIS);
  cv::cvtColor(colours, colours, cv::COLOR_BGR2RGB);
  const auto colour = [&](double db) {
    const double t = (db - scale.min_db) / (scale.max_db - scale.min_db);
    return colours.at<cv::Vec3b>(0, int(std::clamp(255 * t, 0.0, 255.0) + 0.5));
  };
  cv::Mat map = picture(cv::Rect(0, kTop, map_width, height * zoom));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double v = values[std::size_t(y / zoom) * std::size_t(width) + std::size_t(x / zoom)];
      map.at<cv::Vec3b>(y, x) = std::isfinite(v) ? colour(v) : cv::Vec3b(60, 60, 60);
    }
  const std::vector<double> smooth = without_outliers(values, width, height);
  for (double level = scale.contour_db * std::ceil(scale.min_db / scale.contour_db); level <= scale.max_db;
       level += scale.contour_db)
    draw_contours(map, smooth, width, height, zoom, level);

  const int left = map_width + kGap;
  const auto row_of = [&](double db) {
    return kTop + int((scale.max_db - db) / (scale.max_db - scale.min_db) * (map_height - 1));
  };
  for (int y = 0; y < map_height; ++y) {
    const double db = scale.max_db - (scale.max_db - scale.min_db) * (y + 0.5) / map_height;
    const cv::Vec3b c = colour(db);
    cv::line(picture, {left, kTop + y}, {left + kBar, kTop + y}, cv::Scalar(c[0], c[1], c[2]));
  }
  const auto write = [&](const std::string& text, int x, int y) {
    cv::putText(picture, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
  };
  const double step = round_step(scale.min_db, scale.max_db, 7);
  for (double db = step * std::ceil(scale.min_db / step); db <= scale.max_db + 1e-9; db += step) {
    const int y = row_of(db);
    cv::line(picture, {left + kBar, y}, {left + kBar + 4, y}, cv::Scalar(0, 0, 0));
    write(fmt::format("{:g}", std::abs(db) < 1e-9 ? 0.0 : db), left + kBar + 8, y + 4);
  }
  write(scale.title, 4, kTop - 9);

  Image out;
  out.width = picture.cols, out.height = picture.rows, out.channels = {"R", "G", "B"},
  out.srgb_encoded = true;
  out.pixels.resize(picture.total() * 3);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = float(picture.data[i]) / 255;
  return out;
}

}  // namespace aureole
