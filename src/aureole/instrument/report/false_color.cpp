// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/false_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "aureole/core/error.h"
#include "aureole/instrument/report/svg_plot.h"

namespace aureole {
namespace {

struct NamedMap {
  const char* name;
  int map;  ///< colour map number of OpenCV, or -1 for grey
};
constexpr std::array kMaps = {NamedMap{"viridis", cv::COLORMAP_VIRIDIS},
                              NamedMap{"magma", cv::COLORMAP_MAGMA},
                              NamedMap{"inferno", cv::COLORMAP_INFERNO},
                              NamedMap{"plasma", cv::COLORMAP_PLASMA},
                              NamedMap{"cividis", cv::COLORMAP_CIVIDIS},
                              NamedMap{"turbo", cv::COLORMAP_TURBO},
                              NamedMap{"gray", -1}};

/// Returns the 256 colours of a map, as R, G, B.
cv::Mat colors_of(const std::string& name) {
  const auto found =
      std::find_if(kMaps.begin(), kMaps.end(), [&](const NamedMap& m) { return name == m.name; });
  if (found == kMaps.end())
    throw Error(fmt::format("no colour map \"{}\"; there are {}", name, fmt::join(color_scale_maps(), ", ")));
  cv::Mat ramp(1, 256, CV_8UC1), colors;
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = std::uint8_t(i);
  if (found->map < 0) {
    cv::cvtColor(ramp, colors, cv::COLOR_GRAY2RGB);
  } else {
    cv::applyColorMap(ramp, colors, found->map);
    cv::cvtColor(colors, colors, cv::COLOR_BGR2RGB);
  }
  return colors;
}

/// Returns the position of a number on the scale, 0 at its low end and 1 at its high end.
double position(const ColorScale& scale, double value) {
  if (scale.is_logarithmic) return std::log(value / scale.low) / std::log(scale.high / scale.low);
  return (value - scale.low) / (scale.high - scale.low);
}

bool has_color(const ColorScale& scale, double value) {
  return std::isfinite(value) && (!scale.is_logarithmic || value > 0);
}

/// The median of the finite values among the 3 x 3 cells around each cell; without it, contours would follow
/// the noise.
std::vector<double> without_outliers(std::span<const double> values, int width, int height) {
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
  constexpr int kFine = 16;  // subdivisions of a pixel in OpenCV's coordinates
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

const std::vector<std::string>& color_scale_maps() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const NamedMap& map : kMaps) all.emplace_back(map.name);
    return all;
  }();
  return names;
}

std::vector<double> scale_labels(const ColorScale& scale) {
  std::vector<double> labels;
  if (scale.is_logarithmic) {
    // Labels on a logarithmic scale: multiples of 1, 2, 5 within few decades, else powers of ten.
    const double decades = std::log10(scale.high / scale.low);
    const int stride = std::max(1, int(std::ceil(decades / 7)));
    for (int e = int(std::floor(std::log10(scale.low))); e <= int(std::ceil(std::log10(scale.high))); ++e)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double value = factor * std::pow(10, e);
        const bool wanted = factor == 1 ? e % stride == 0 : decades <= 2.4;
        if (wanted && value >= scale.low * (1 - 1e-9) && value <= scale.high * (1 + 1e-9))
          labels.push_back(value);
      }
    if (labels.size() < 2) labels = {scale.low, scale.high};
    return labels;
  }
  const double step = round_step(scale.low, scale.high, 7);
  for (double value = step * std::ceil(scale.low / step); value <= scale.high + 1e-9 * step; value += step)
    labels.push_back(std::abs(value) < 1e-9 * step ? 0.0 : value);
  return labels;
}

Image false_color_picture(std::span<const double> values, int width, int height, const ColorScale& scale,
                          int side) {
  if (!(scale.high > scale.low && std::isfinite(scale.high - scale.low)))
    throw Error(fmt::format("no colours from {:g} to {:g}: the scale must rise", scale.low, scale.high));
  if (scale.is_logarithmic && !(scale.low > 0))
    throw Error(fmt::format("a logarithmic scale begins above 0, not at {:g}", scale.low));
  const cv::Mat colors = colors_of(scale.map);
  const auto color = [&](double value) {
    return colors.at<cv::Vec3b>(0, int(std::clamp(255 * position(scale, value), 0.0, 255.0) + 0.5));
  };
  const int zoom = std::max(1, side / std::max(width, height));
  const int map_width = width * zoom, map_height = std::max(height * zoom, 160);
  constexpr int kGap = 14, kBar = 18, kLabels = 58, kTop = 26;
  cv::Mat picture(map_height + kTop + kGap, map_width + 2 * kGap + kBar + kLabels, CV_8UC3,
                  cv::Scalar(255, 255, 255));
  cv::Mat map = picture(cv::Rect(0, kTop, map_width, height * zoom));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double v = values[std::size_t(y / zoom) * std::size_t(width) + std::size_t(x / zoom)];
      map.at<cv::Vec3b>(y, x) = has_color(scale, v) ? color(v) : cv::Vec3b(60, 60, 60);
    }
  if (!scale.contours.empty()) {
    const std::vector<double> smooth = without_outliers(values, width, height);
    for (const double level : scale.contours) draw_contours(map, smooth, width, height, zoom, level);
  }

  const int left = map_width + kGap;
  for (int y = 0; y < map_height; ++y) {
    const auto at = int(std::clamp(255 * (1 - (y + 0.5) / map_height), 0.0, 255.0) + 0.5);
    const cv::Vec3b c = colors.at<cv::Vec3b>(0, at);
    cv::line(picture, {left, kTop + y}, {left + kBar, kTop + y}, cv::Scalar(c[0], c[1], c[2]));
  }
  // White lines across the scale are the values of the contour lines.
  for (const double level : scale.contours)
    if (const double at = position(scale, level); at > 0 && at < 1) {
      const int y = kTop + int((1 - at) * (map_height - 1));
      cv::line(picture, {left, y}, {left + kBar, y}, cv::Scalar(255, 255, 255));
    }
  const auto write_run = [&](const std::string& text, int& x, int y, double size) {
    cv::putText(picture, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
    int baseline = 0;
    x += cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline).width;
  };
  // Powers such as "m^2" get raised digits.
  const auto write = [&](const std::string& text, int x, int y) {
    constexpr double kSize = 0.42, kRaised = 0.3;
    for (std::size_t i = 0; i < text.size();) {
      const std::size_t power = std::min(text.find('^', i), text.size());
      write_run(text.substr(i, power - i), x, y, kSize);
      if (power == text.size()) break;
      const std::size_t end = std::min(text.find_first_not_of("-0123456789", power + 1), text.size());
      write_run(text.substr(power + 1, end - power - 1), x, y - 5, kRaised);
      i = end;
    }
  };
  for (const double label : scale_labels(scale)) {
    const int y = kTop + int((1 - position(scale, label)) * (map_height - 1));
    cv::line(picture, {left + kBar, y}, {left + kBar + 4, y}, cv::Scalar(0, 0, 0));
    write(fmt::format("{:.4g}", label), left + kBar + 8, y + 4);
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
