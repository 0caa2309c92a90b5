// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "aureole/instrument/report/microstructure_report.h"

namespace aureole {

Image overlay(const Micrograph& field, const Segmentation& s, const std::vector<Particle>& particles) {
  const int w = field.width, h = field.height;
  std::vector<float> sorted = field.grey;
  const auto quantile = [&](double q) {
    const auto at = sorted.begin() + long(q * double(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  };
  const float low = quantile(0.002), high = std::max(quantile(0.998), low + 1e-6f);
  // Small pictures are enlarged, so that a line is thinner than a particle.
  const int zoom = std::clamp(1200 / std::max(w, h), 1, 4);
  cv::Mat picture(h * zoom, w * zoom, CV_8UC3);
  for (int y = 0; y < h * zoom; ++y)
    for (int x = 0; x < w * zoom; ++x) {
      const size_t i = size_t(y / zoom) * w + size_t(x / zoom);
      const float v = std::clamp((field.grey[i] - low) / (high - low), 0.f, 1.f);
      const bool seen = field.seen.empty() || field.seen[i];
      const auto g = cv::saturate_cast<std::uint8_t>(255 * v);
      picture.at<cv::Vec3b>(y, x) = seen ? cv::Vec3b(g, g, g) : cv::Vec3b(g / 2 + 60, g / 2, g / 2);
    }
  const auto to = [&](double x, double y) { return cv::Point(int(x * zoom * 16), int(y * zoom * 16)); };
  for (const Particle& p : particles) {
    const cv::Scalar colour = p.cut ? cv::Scalar(255, 140, 0) : cv::Scalar(0, 200, 60);
    std::vector<cv::Point> line;
    for (const auto& q : p.outline) line.push_back(to(q[0] - 0.5 / zoom, q[1] - 0.5 / zoom));
    if (!line.empty()) cv::polylines(picture, line, true, colour, 1, cv::LINE_AA, 4);
    const cv::Point c(int(p.x * zoom), int(p.y * zoom));
    cv::line(picture, c - cv::Point(2, 0), c + cv::Point(2, 0), cv::Scalar(230, 0, 60));
    cv::line(picture, c - cv::Point(0, 2), c + cv::Point(0, 2), cv::Scalar(230, 0, 60));
  }
  // Cut particles have no closed outline; their boundary pixels are drawn instead.
  std::vector<char> cut(size_t(s.count) + 1, 1);
  for (const Particle& p : particles)
    if (!p.cut)
      cut[size_t(
          s.labels[size_t(std::clamp(int(p.y), 0, h - 1)) * w + size_t(std::clamp(int(p.x), 0, w - 1))])] = 0;
  for (int y = 1; y + 1 < h; ++y)
    for (int x = 1; x + 1 < w; ++x) {
      const size_t i = size_t(y) * w + x;
      if (!s.labels[i] || !cut[size_t(s.labels[i])] || !(s.depth[i] > 0) || s.depth[i] > 1.01f) continue;
      cv::rectangle(picture, cv::Rect(x * zoom, y * zoom, zoom, zoom), cv::Scalar(255, 140, 0), cv::FILLED);
    }
  Image out;
  out.width = picture.cols, out.height = picture.rows, out.channels = {"R", "G", "B"},
  out.srgb_encoded = true;
  out.pixels.resize(picture.total() * 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = float(picture.data[i]) / 255;
  return out;
}

}  // namespace aureole
