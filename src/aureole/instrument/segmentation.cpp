// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/segmentation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "aureole/core/error.h"
#include "aureole/instrument/even_light.h"

namespace aureole {
namespace {

template <class T>
T median(std::vector<T> v) {
  if (v.empty()) return T(0);
  std::nth_element(v.begin(), v.begin() + long(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Standard deviation of white noise, from what is left of a plane (Immerkaer, "Fast noise variance
/// estimation", 1996), by the median, which edges do not reach.
double noise_level(const cv::Mat& grey, const cv::Mat& seen) {
  const cv::Matx33f kernel(1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat rest;
  cv::filter2D(grey, rest, CV_32F, kernel);
  std::vector<float> values;
  for (int y = 1; y + 1 < grey.rows; ++y)
    for (int x = 1; x + 1 < grey.cols; ++x)
      if (seen.at<std::uint8_t>(y, x)) values.push_back(std::abs(rest.at<float>(y, x)));
  return median(std::move(values)) / 0.6745 / 6;
}

/// Single pixels far from all around them, as of hot pixels.
bool has_impulses(const cv::Mat& grey, const cv::Mat& median3, double noise, double contrast) {
  const double far = std::max(6 * noise, 0.25 * contrast);
  cv::Mat difference;
  cv::absdiff(grey, median3, difference);
  return cv::countNonZero(difference > far) > 5e-4 * double(grey.total());
}

double blurred(const cv::Mat& from, cv::Mat& to, double sigma) {
  if (sigma > 0)
    cv::GaussianBlur(from, to, {0, 0}, sigma, sigma, cv::BORDER_REPLICATE);
  else
    to = from.clone();
  return sigma;
}

/// (convex - concave)/(convex + concave) length of the level 1/2, seen from the bright side: the sign of the
/// divergence of the unit gradient where the values are near 1/2.
double convexity(const cv::Mat& coverage, const cv::Mat& seen) {
  cv::Mat s, gx, gy;
  blurred(coverage, s, 1.5);
  cv::Sobel(s, gx, CV_32F, 1, 0, 3, 0.125), cv::Sobel(s, gy, CV_32F, 0, 1, 3, 0.125);
  cv::Mat length, nx, ny, kx, ky;
  cv::magnitude(gx, gy, length);
  length += 1e-6;
  cv::divide(gx, length, nx), cv::divide(gy, length, ny);
  cv::Sobel(nx, kx, CV_32F, 1, 0, 3, 0.125), cv::Sobel(ny, ky, CV_32F, 0, 1, 3, 0.125);
  double sum = 0, total = 0;
  for (int y = 2; y + 2 < s.rows; ++y)
    for (int x = 2; x + 2 < s.cols; ++x) {
      if (!(std::abs(s.at<float>(y, x) - 0.5f) < 0.2f) || !seen.at<std::uint8_t>(y, x)) continue;
      const double w = length.at<float>(y, x), k = -(kx.at<float>(y, x) + ky.at<float>(y, x));
      sum += w * (k > 0 ? 1 : -1), total += w;
    }
  return total > 0 ? sum / total : 0;
}

/// Standard deviation of the blur of edges that are sharp in truth, from their slope.
double edge_blur(const cv::Mat& smooth, const cv::Mat& seen, double sigma) {
  cv::Mat gx, gy;
  cv::Sobel(smooth, gx, CV_32F, 1, 0, 3, 0.125), cv::Sobel(smooth, gy, CV_32F, 0, 1, 3, 0.125);
  std::vector<float> slopes;
  for (int y = 1; y + 1 < smooth.rows; ++y)
    for (int x = 1; x + 1 < smooth.cols; ++x)
      if (seen.at<std::uint8_t>(y, x) && std::abs(smooth.at<float>(y, x) - 0.5f) < 0.1f)
        slopes.push_back(std::hypot(gx.at<float>(y, x), gy.at<float>(y, x)));
  const double slope = median(std::move(slopes));
  if (!(slope > 0)) return 1;
  // Sobel's operator smooths as well: about 0.7 pixels.
  const double total = 1 / (slope * std::sqrt(2 * M_PI));
  return std::sqrt(std::max(total * total - sigma * sigma - 0.5, 0.0));
}

cv::Mat normalised(const cv::Mat& grey, const Levels& levels, double least) {
  cv::Mat contrast = cv::max(levels.bright - levels.dark, least), v;
  cv::divide(grey - levels.dark, contrast, v);
  return v;
}

void fill_holes(cv::Mat& inside) {
  // Ground that does not reach the frame, as long as it is smaller than the particle around it.
  cv::Mat ground = (inside == 0), labels, stats, centres;
  const int n = cv::connectedComponentsWithStats(ground, labels, stats, centres, 4);
  std::vector<char> fill(size_t(n), 0);
  for (int i = 1; i < n; ++i) {
    const int* s = stats.ptr<int>(i);
    fill[size_t(i)] = s[cv::CC_STAT_LEFT] > 0 && s[cv::CC_STAT_TOP] > 0 &&
                      s[cv::CC_STAT_LEFT] + s[cv::CC_STAT_WIDTH] < inside.cols &&
                      s[cv::CC_STAT_TOP] + s[cv::CC_STAT_HEIGHT] < inside.rows;
  }
  for (int y = 0; y < inside.rows; ++y)
    for (int x = 0; x < inside.cols; ++x)
      if (fill[size_t(labels.at<int>(y, x))]) inside.at<std::uint8_t>(y, x) = 255;
}

cv::Mat depth_of(const cv::Mat& inside) {
  cv::Mat depth;
  cv::distanceTransform(inside, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return depth;
}

/// Half the width of a typical particle: the median over its pixels of the deepest pixel near them would do;
/// the 99 % quantile of depth is near it and costs nothing.
double typical_radius(const cv::Mat& inside) {
  const cv::Mat depth = depth_of(inside);
  std::vector<float> d;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      if (depth.at<float>(y, x) > 0) d.push_back(depth.at<float>(y, x));
  if (d.empty()) return 4;
  std::nth_element(d.begin(), d.begin() + long(d.size() * 99 / 100), d.end());
  return d[d.size() * 99 / 100];
}

}  // namespace

Segmentation segment(const Micrograph& field, const SegmentationOptions& o) {
  const auto fail = [&](const std::string& what) { throw Error({field.name, 0, 0}, what); };
  const int w = field.width, h = field.height;
  Segmentation out;
  out.width = w, out.height = h;
  cv::Mat grey(h, w, CV_32F, const_cast<float*>(field.grey.data()));
  grey = grey.clone();
  cv::Mat seen(h, w, CV_8U, cv::Scalar(255));
  if (!field.seen.empty())
    for (size_t i = 0; i < field.seen.size(); ++i) seen.data[i] = field.seen[i] ? 255 : 0;
  // What is not seen must not raise or lower anything around it.
  const cv::Scalar mean = cv::mean(grey, seen);
  grey.setTo(mean, seen == 0);

  std::vector<float> sorted;
  for (size_t i = 0; i < grey.total(); i += 1 + grey.total() / 200000) sorted.push_back(grey.ptr<float>()[i]);
  std::sort(sorted.begin(), sorted.end());
  const double span = sorted[sorted.size() - 1 - sorted.size() / 200] - sorted[sorted.size() / 200];
  double noise = noise_level(grey, seen);
  if (!(span > 0)) fail("has one grey value only: there is nothing to see");
  cv::Mat median3;
  cv::medianBlur(grey, median3, 3);
  if (o.denoise == Denoise::median ||
      (o.denoise == Denoise::automatic && has_impulses(grey, median3, noise, span)))
    grey = median3, noise *= 0.4;

  // Noise of what is thresholded, relative to the contrast, should be below 0.06: the outline is then the
  // outline.
  double sigma = o.smooth;
  if (o.denoise == Denoise::none)
    sigma = 0;
  else if (sigma == 0)
    sigma = std::clamp(noise / (2 * std::sqrt(M_PI) * 0.06 * span), 0.5, 3.0);
  cv::Mat smooth;
  blurred(grey, smooth, sigma);

  cv::Mat bright = smooth > first_threshold(smooth, seen);
  cv::Mat coverage;
  double scale = o.background_scale;
  for (int pass = 0; pass < 4; ++pass) {
    // Which class the particles are is not known yet; the smaller typical width is that of both for dense
    // layers, and of the particles for thin ones.
    if (o.background_scale == 0)
      scale = std::clamp(8 * std::min(typical_radius(bright), typical_radius(~bright)), 24.0,
                         0.5 * std::max(w, h));
    Levels levels;
    if (o.background == Background::morphology) {
      levels = morphological_levels(smooth, scale);
    } else {
      const bool flat = o.background == Background::none;
      levels = fit_levels(grey, bright, seen, std::max(2.0, 3 * out.blur), flat ? 1e5 : scale);
      if (levels.dark.empty() || levels.bright.empty()) fail("has no contrast: no particles found");
      if (flat) levels.dark.setTo(cv::mean(levels.dark)), levels.bright.setTo(cv::mean(levels.bright));
    }
    out.contrast = cv::mean(levels.bright - levels.dark, seen)[0];
    if (!(out.contrast > 0)) fail("has no contrast: no particles found");
    coverage = normalised(grey, levels, 0.1 * out.contrast);
    cv::Mat s = normalised(smooth, levels, 0.1 * out.contrast);
    bright = s > 0.5;
    out.blur = edge_blur(s, seen, sigma);
    if (pass == 3) smooth = s;
  }
  out.noise = noise / out.contrast;
  // The two levels of mere noise are closer together than a few of its standard deviations.
  if (out.contrast < 6 * noise / (2 * std::sqrt(M_PI) * std::max(sigma, 0.5)) + 1e-6)
    fail("has no contrast above its noise: no particles found");

  const double convex = convexity(coverage, seen);
  out.polarity_score = std::abs(convex);
  out.bright = o.polarity == Polarity::bright || (o.polarity == Polarity::automatic && convex > 0);
  if (o.polarity == Polarity::automatic && std::abs(convex) < 0.05)
    fail("cannot tell whether particles are dark or bright; give --polarity dark or bright");
  if (!out.bright) {
    coverage = 1 - coverage;
    smooth = 1 - smooth;
  }
  cv::Mat inside = smooth > 0.5;
  if (o.fill_holes) {
    cv::Mat before = inside.clone();
    fill_holes(inside);
    cv::Mat core;
    cv::erode(inside, core, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
    const cv::Mat filled = (core != 0) & (before == 0);
    coverage.setTo(1, filled), smooth.setTo(1, filled);
  }
  cv::Mat depth = depth_of(inside);
  depth.setTo(0, seen == 0);
  coverage.setTo(0, seen == 0), smooth.setTo(0, seen == 0);
  // Noise around 0 and 1 cancels in sums; a halo or a glint is neither particle nor ground.
  const double beyond = std::max(4 * out.noise, 0.02);
  coverage = cv::min(cv::max(coverage, -beyond), 1 + beyond);

  const auto to_vector = [](const cv::Mat& m) {
    return std::vector<float>(m.ptr<float>(), m.ptr<float>() + m.total());
  };
  out.depth = to_vector(depth);
  int count = 0;
  std::vector<int> labels = divide(out.depth, w, h, count);
  std::vector<int> pixels(size_t(count) + 1), name(size_t(count) + 1);
  std::vector<char> at_frame(size_t(count) + 1, 0);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const size_t l = size_t(labels[size_t(y) * w + x]);
      ++pixels[l];
      if (x == 0 || y == 0 || x == w - 1 || y == h - 1) at_frame[l] = 1;
    }
  for (int i = 1; i <= count; ++i) {
    if (pixels[size_t(i)] >= M_PI * o.min_radius * o.min_radius)
      name[size_t(i)] = ++out.count;
    else if (!at_frame[size_t(i)])
      ++out.too_small;
  }
  for (int& l : labels) l = name[size_t(l)];

  // Pixels just outside belong to the nearest particle: they hold the rest of its blurred edge.
  out.band = std::clamp(int(std::ceil(3 * std::hypot(out.blur, 0.3))), 2, 6);
  cv::Mat outside(h, w, CV_8U), nearest, distance;
  for (size_t i = 0; i < labels.size(); ++i) outside.data[i] = labels[i] ? 0 : 255;
  if (out.count > 0) {
    cv::distanceTransform(outside, distance, nearest, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
    std::vector<int> of(size_t(w) * h + 1);
    for (size_t i = 0; i < labels.size(); ++i)
      if (labels[i]) of[size_t(nearest.ptr<int>()[i])] = labels[i];
    for (size_t i = 0; i < labels.size(); ++i)
      if (!labels[i] && seen.data[i] && distance.ptr<float>()[i] <= float(out.band))
        labels[i] = of[size_t(nearest.ptr<int>()[i])];
  }
  out.labels = std::move(labels);
  out.coverage = to_vector(coverage), out.smooth = to_vector(smooth);
  return out;
}

}  // namespace aureole
