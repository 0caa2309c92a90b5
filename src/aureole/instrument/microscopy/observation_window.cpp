// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/observation_window.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace aureole {

ObservationWindow::ObservationWindow(int width, int height, const std::vector<std::uint8_t>& seen)
    : width_(width), height_(height), most_(0.5 * std::min(width, height)) {
  if (seen.empty()) return;
  cv::Mat bordered(height + 2, width + 2, CV_8U, cv::Scalar(0));
  for (int y = 0; y < height; ++y)
    std::copy_n(seen.data() + size_t(y) * width, width, bordered.ptr<std::uint8_t>(y + 1) + 1);
  cv::Mat distance;
  cv::distanceTransform(bordered, distance, cv::DIST_C, 3);
  free_.resize(seen.size());
  most_ = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The distance transform counts to the next pixel centre outside; that pixel's edge is half a pixel
      // nearer.
      const float d = std::max(distance.at<float>(y + 1, x + 1) - 0.5f, 0.f);
      free_[size_t(y) * width + x] = d;
      most_ = std::max(most_, double(d));
    }
  area_from_.assign(size_t(2 * most_) + 3, 0);
  for (const float d : free_)
    if (d > 0) area_from_[size_t(2 * d)] += 1;
  for (size_t i = area_from_.size() - 1; i-- > 0;) area_from_[i] += area_from_[i + 1];
}

double ObservationWindow::free(double x, double y) const {
  const double to_frame = std::min({x, y, width_ - x, height_ - y});
  if (!(to_frame > 0)) return 0;
  if (free_.empty()) return to_frame;
  const int i = std::min(int(x), width_ - 1), j = std::min(int(y), height_ - 1);
  return std::min<double>(free_[size_t(j) * width_ + i], to_frame);
}

double ObservationWindow::area(double reach) const {
  if (free_.empty()) return std::max(width_ - 2 * reach, 0.0) * std::max(height_ - 2 * reach, 0.0);
  // Free distances are odd multiples of 1/2; areas are interpolated linearly between them.
  const double at = std::max(2 * reach - 1, 0.0) / 2;
  const size_t i = size_t(at), a = 2 * i + 1, b = a + 2;
  const auto from = [&](size_t k) { return k < area_from_.size() ? area_from_[k] : 0.0; };
  return from(a) + (at - double(i)) * (from(b) - from(a));
}

ObservationWindow::Raster ObservationWindow::raster(double reach, int side) const {
  Raster r;
  const double cell = std::max(1.0, double(std::max(width_, height_)) / side);
  r.width = std::max(1, int(width_ / cell)), r.height = std::max(1, int(height_ / cell));
  r.cell_x = double(width_) / r.width, r.cell_y = double(height_) / r.height;
  r.free.resize(size_t(r.width) * r.height), r.inside.resize(r.free.size());
  constexpr int kSub = 4;
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x) {
      double sum = 0, inside = 0;
      for (int j = 0; j < kSub; ++j)
        for (int i = 0; i < kSub; ++i) {
          const double d = free((x + (i + 0.5) / kSub) * r.cell_x, (y + (j + 0.5) / kSub) * r.cell_y);
          if (d > 0 && d >= reach) sum += d - reach, inside += 1;
        }
      r.free[size_t(y) * r.width + x] = float(sum / (kSub * kSub));
      r.inside[size_t(y) * r.width + x] = float(inside / (kSub * kSub));
    }
  return r;
}

SetCovariance::SetCovariance(const ObservationWindow& window, double reach, bool masked)
    : width_(std::max(window.width() - 2 * reach, 0.0)), height_(std::max(window.height() - 2 * reach, 0.0)) {
  if (!masked) return;
  const ObservationWindow::Raster r = window.raster(reach, 512);
  cell_x_ = r.cell_x, cell_y_ = r.cell_y;
  columns_ = cv::getOptimalDFTSize(2 * r.width), rows_ = cv::getOptimalDFTSize(2 * r.height);
  cv::Mat padded(rows_, columns_, CV_32F, cv::Scalar(0)), spectrum;
  for (int y = 0; y < r.height; ++y)
    std::copy_n(r.inside.data() + size_t(y) * r.width, r.width, padded.ptr<float>(y));
  cv::dft(padded, spectrum);
  cv::mulSpectrums(spectrum, spectrum, spectrum, 0, true);
  cv::dft(spectrum, padded, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  table_.resize(size_t(rows_) * columns_);
  for (int y = 0; y < rows_; ++y) {
    const float* row = padded.ptr<float>(y);
    for (int x = 0; x < columns_; ++x) table_[size_t(y) * columns_ + x] = row[x] * float(cell_x_ * cell_y_);
  }
}

double SetCovariance::operator()(double dx, double dy) const {
  if (table_.empty()) return std::max(width_ - std::abs(dx), 0.0) * std::max(height_ - std::abs(dy), 0.0);
  const double x = std::abs(dx) / cell_x_, y = (dx < 0 ? -dy : dy) / cell_y_;
  const double fx = std::floor(x), fy = std::floor(y);
  const auto at = [&](int i, int j) {
    return double(table_[size_t((j % rows_ + rows_) % rows_) * columns_ + size_t(i % columns_)]);
  };
  const int i = int(fx), j = int(fy);
  const double a = at(i, j) + (x - fx) * (at(i + 1, j) - at(i, j));
  const double b = at(i, j + 1) + (x - fx) * (at(i + 1, j + 1) - at(i, j + 1));
  return a + (y - fy) * (b - a);
}

}  // namespace aureole
