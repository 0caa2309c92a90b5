// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/even_light.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace aureole {
namespace {

/// Weighted least squares fit of a value by 1, x, y, x^2, xy, y^2 over the field, with x and y in [-1, 1].
class Polynomial {
public:
  static constexpr int kTerms = 6;
  Polynomial(int width, int height) : width_(width), height_(height) {}

  void add(int x, int y, double value, double weight) {
    double t[kTerms];
    terms(x, y, t);
    for (int a = 0; a < kTerms; ++a) {
      for (int b = 0; b < kTerms; ++b) matrix_(a, b) += weight * t[a] * t[b];
      right_(a) += weight * t[a] * value;
    }
    sum_ += weight;
  }
  bool is_empty() const { return !(sum_ > 0); }
  void solve() {
    // Weak ridge regularisation, since a class present in one corner only determines no curvature.
    cv::Matx<double, kTerms, kTerms> m = matrix_ * (1 / sum_);
    for (int a = 1; a < kTerms; ++a) m(a, a) += 1e-6;
    cv::Matx<double, kTerms, 1> x;
    cv::solve(m, right_ * (1 / sum_), x, cv::DECOMP_CHOLESKY);
    for (int a = 0; a < kTerms; ++a) coefficients_[a] = x(a);
  }
  double at(int x, int y) const {
    double t[kTerms], v = 0;
    terms(x, y, t);
    for (int a = 0; a < kTerms; ++a) v += coefficients_[a] * t[a];
    return v;
  }

private:
  void terms(int i, int j, double* t) const {
    const double x = 2 * (i + 0.5) / width_ - 1, y = 2 * (j + 0.5) / height_ - 1;
    t[0] = 1, t[1] = x, t[2] = y, t[3] = x * x, t[4] = x * y, t[5] = y * y;
  }
  int width_, height_;
  double sum_ = 0, coefficients_[kTerms] = {};
  cv::Matx<double, kTerms, kTerms> matrix_ = cv::Matx<double, kTerms, kTerms>::zeros();
  cv::Matx<double, kTerms, 1> right_ = cv::Matx<double, kTerms, 1>::zeros();
};

void average(cv::Mat& m, double sigma) {
  cv::GaussianBlur(m, m, cv::Size(0, 0), sigma, sigma, cv::BORDER_ISOLATED | cv::BORDER_CONSTANT);
}

/// Fits one surface to the pixels of `grey` where `core` is not 0.
cv::Mat surface(const cv::Mat& grey, const cv::Mat& core, double scale) {
  const int w = grey.cols, h = grey.rows;
  Polynomial p(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (core.at<std::uint8_t>(y, x)) p.add(x, y, grey.at<float>(y, x), 1);
  if (p.is_empty()) return {};
  p.solve();
  // The residual of the polynomial, at a resolution of 1/8 of the scale.
  const double step = std::max(1.0, scale / 8);
  const int cw = std::max(1, int(w / step)), ch = std::max(1, int(h / step));
  cv::Mat sum(ch, cw, CV_32F, cv::Scalar(0)), weight(ch, cw, CV_32F, cv::Scalar(0));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (core.at<std::uint8_t>(y, x)) {
        const int i = int(std::int64_t(x) * cw / w), j = int(std::int64_t(y) * ch / h);
        sum.at<float>(j, i) += float(grey.at<float>(y, x) - p.at(x, y));
        weight.at<float>(j, i) += 1;
      }
  average(sum, scale / step), average(weight, scale / step);
  double most = 0;
  cv::minMaxLoc(weight, nullptr, &most);
  // Where hardly any pixel of the class is near, only the polynomial counts.
  cv::Mat rest, denominator = weight + 0.02 * most;
  cv::divide(sum, denominator, rest);
  cv::resize(rest, rest, grey.size(), 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) rest.at<float>(y, x) += float(p.at(x, y));
  return rest;
}

}  // namespace

cv::Mat first_threshold(const cv::Mat& smooth, const cv::Mat& seen) {
  const int side = std::max(15, std::min(smooth.cols, smooth.rows) / 6) | 1;
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {side, side});
  cv::Mat high, low;
  cv::dilate(smooth, high, square), cv::erode(smooth, low, square);
  Polynomial p(smooth.cols, smooth.rows);
  for (int y = 0; y < smooth.rows; ++y)
    for (int x = 0; x < smooth.cols; ++x)
      if (seen.at<std::uint8_t>(y, x)) {
        const double a = low.at<float>(y, x), b = high.at<float>(y, x);
        // Neighbourhoods without contrast contain one class only and determine no threshold.
        p.add(x, y, 0.5 * (a + b), (b - a) * (b - a));
      }
  cv::Mat threshold(smooth.size(), CV_32F, cv::Scalar(0));
  if (p.is_empty()) return threshold;
  p.solve();
  for (int y = 0; y < smooth.rows; ++y)
    for (int x = 0; x < smooth.cols; ++x) threshold.at<float>(y, x) = float(p.at(x, y));
  return threshold;
}

Levels fit_levels(const cv::Mat& grey, const cv::Mat& bright_class, const cv::Mat& seen, double core,
                  double scale) {
  Levels levels;
  const double enough = std::max(100.0, 5e-4 * double(grey.total()));
  for (const bool bright : {false, true}) {
    cv::Mat mine = bright ? (bright_class != 0) : (bright_class == 0), distance;
    // The border of the field is not an edge of a class.
    cv::copyMakeBorder(mine, mine, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
    cv::distanceTransform(mine, distance, cv::DIST_L2, 5);
    distance = distance(cv::Rect(1, 1, grey.cols, grey.rows));
    cv::Mat& level = bright ? levels.bright : levels.dark;
    for (double depth = core;; depth -= 0.5) {
      const cv::Mat pixels = (distance > depth + 0.5) & (seen != 0);
      if (cv::countNonZero(pixels) < enough && depth > 0) continue;
      level = surface(grey, pixels, scale);
      break;
    }
  }
  return levels;
}

Levels morphological_levels(const cv::Mat& smooth, double scale) {
  const int side = std::max(3, int(std::lround(scale))) | 1;
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {side, side});
  Levels levels;
  cv::morphologyEx(smooth, levels.bright, cv::MORPH_CLOSE, square);
  cv::morphologyEx(smooth, levels.dark, cv::MORPH_OPEN, square);
  for (cv::Mat* m : {&levels.bright, &levels.dark})
    cv::GaussianBlur(*m, *m, {0, 0}, scale / 2, scale / 2, cv::BORDER_REPLICATE);
  return levels;
}

}  // namespace aureole
