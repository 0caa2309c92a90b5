// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/false_colour.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace aureole {

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

Image false_colour_picture(const std::vector<double>& values, int width, int height,
                           const ColourScale& scale) {
  const int zoom = std::max(1, 640 / std::max(width, height));
  const int map_width = width * zoom, map_height = std::max(height * zoom, 160);
  constexpr int kGap = 14, kBar = 18, kLabels = 58, kTop = 26;
  cv::Mat picture(map_height + kTop + kGap, map_width + 2 * kGap + kBar + kLabels, CV_8UC3,
                  cv::Scalar(255, 255, 255));

  cv::Mat ramp(1, 256, CV_8UC1), colours;
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = std::uint8_t(i);
  cv::applyColorMap(ramp, colours, cv::COLORMAP_VIRIDIS);
  cv::cvtColor(colours, colours, cv::COLOR_BGR2RGB);
  const auto colour = [&](double value) {
    const double t = (value - scale.min) / (scale.max - scale.min);
    return colours.at<cv::Vec3b>(0, int(std::clamp(255 * t, 0.0, 255.0) + 0.5));
  };
  cv::Mat map = picture(cv::Rect(0, kTop, map_width, height * zoom));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double v = values[std::size_t(y / zoom) * std::size_t(width) + std::size_t(x / zoom)];
      map.at<cv::Vec3b>(y, x) = std::isfinite(v) ? colour(v) : cv::Vec3b(60, 60, 60);
    }
  const std::vector<double> smooth = without_outliers(values, width, height);
  for (const double level : scale.isolines) draw_contours(map, smooth, width, height, zoom, level);

  const int left = map_width + kGap;
  const auto row_of = [&](double value) {
    return kTop + int((scale.max - value) / (scale.max - scale.min) * (map_height - 1));
  };
  for (int y = 0; y < map_height; ++y) {
    const cv::Vec3b c = colour(scale.max - (scale.max - scale.min) * (y + 0.5) / map_height);
    cv::line(picture, {left, kTop + y}, {left + kBar, kTop + y}, cv::Scalar(c[0], c[1], c[2]));
  }
  const auto write = [&](const std::string& text, int x, int y) {
    cv::putText(picture, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
  };
  for (const auto& [value, label] : scale.labels) {
    const int y = row_of(value);
    cv::line(picture, {left + kBar, y}, {left + kBar + 4, y}, cv::Scalar(0, 0, 0));
    write(label, left + kBar + 8, y + 4);
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
