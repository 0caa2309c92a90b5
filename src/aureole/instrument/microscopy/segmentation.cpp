// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/segmentation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "aureole/core/error.h"
#include "aureole/instrument/microscopy/even_light.h"

namespace aureole {
namespace {

template <class T>
T median(std::vector<T> v) {
  if (v.empty()) return T(0);
  std::nth_element(v.begin(), v.begin() + long(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Standard deviation of white noise, from the residual of locally planar values (Immerkaer, "Fast noise
/// variance estimation", 1996). The median makes it robust against edges.
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

/// Whether single pixels differ greatly from all their neighbours, as hot pixels do.
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

/// Returns (convex - concave)/(convex + concave) length of the level 1/2, as seen from the bright side. The
/// sign is that of the divergence of the unit gradient at values near 1/2.
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

/// Standard deviation of the blur of edges, from their slope, assuming that the actual edges are sharp.
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
  // Sobel's operator adds about 0.7 pixels of smoothing.
  const double total = 1 / (slope * std::sqrt(2 * M_PI));
  return std::sqrt(std::max(total * total - sigma * sigma - 0.5, 0.0));
}

cv::Mat normalised(const cv::Mat& grey, const Levels& levels, double least) {
  cv::Mat contrast = cv::max(levels.bright - levels.dark, least), v;
  cv::divide(grey - levels.dark, contrast, v);
  return v;
}

void fill_holes(cv::Mat& inside) {
  // Fills ground regions that do not reach the frame and are smaller than the particle around them.
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

/// Half the width of a typical particle: the 99 % quantile of depth. It is cheap and close to the median over
/// all pixels of the greatest depth near them.
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

[[noreturn]] void fail(const Micrograph& field, const std::string& what) {
  throw Error({field.name, 0, 0}, what);
}

std::vector<float> to_vector(const cv::Mat& m) {
  return std::vector<float>(m.ptr<float>(), m.ptr<float>() + m.total());
}

/// Intermediate pictures on the path from a micrograph to particles.
struct Pictures {
  cv::Mat grey, seen;  ///< grey values without hot pixels; mask with 255 for usable pixels
  double span = 0;     ///< difference of the 0.5 % and 99.5 % quantiles of the grey values
  double noise = 0;    ///< standard deviation of the grey values
  double sigma = 0;    ///< standard deviation of the smoothing Gaussian [pixels]
  cv::Mat smooth;      ///< smoothed grey values; after `even_out` smoothed coverage
  cv::Mat coverage;    ///< 1 in the brighter class, 0 in the other; after `orient` 1 in particles
};

Pictures read_pictures(const Micrograph& field, const SegmentationOptions& o) {
  const int w = field.width, h = field.height;
  Pictures p;
  p.grey = cv::Mat(h, w, CV_32F, const_cast<float*>(field.grey.data())).clone();
  p.seen = cv::Mat(h, w, CV_8U, cv::Scalar(255));
  if (!field.seen.empty())
    for (size_t i = 0; i < field.seen.size(); ++i) p.seen.data[i] = field.seen[i] ? 255 : 0;
  // Excluded pixels get the mean, so that they do not affect their neighbours.
  const cv::Scalar mean = cv::mean(p.grey, p.seen);
  p.grey.setTo(mean, p.seen == 0);

  std::vector<float> sorted;
  for (size_t i = 0; i < p.grey.total(); i += 1 + p.grey.total() / 200000)
    sorted.push_back(p.grey.ptr<float>()[i]);
  std::sort(sorted.begin(), sorted.end());
  p.span = sorted[sorted.size() - 1 - sorted.size() / 200] - sorted[sorted.size() / 200];
  p.noise = noise_level(p.grey, p.seen);
  if (!(p.span > 0)) fail(field, "has one grey value only: there is nothing to see");
  cv::Mat median3;
  cv::medianBlur(p.grey, median3, 3);
  if (o.denoise == Denoise::median ||
      (o.denoise == Denoise::automatic && has_impulses(p.grey, median3, p.noise, p.span)))
    p.grey = median3, p.noise *= 0.4;

  // The noise of the thresholded picture, relative to the contrast, should be below 0.06, so that outlines
  // follow the particles and not the noise.
  p.sigma = o.smooth;
  if (o.denoise == Denoise::none)
    p.sigma = 0;
  else if (p.sigma == 0)
    p.sigma = std::clamp(p.noise / (2 * std::sqrt(M_PI) * 0.06 * p.span), 0.5, 3.0);
  blurred(p.grey, p.smooth, p.sigma);
  return p;
}

/// Fits the levels of both classes, which vary over the field, and normalises by them. Levels and classes
/// depend on each other, and so four iterations are made. Sets `contrast`, `blur` and `noise` of the result.
void even_out(Pictures& p, const Micrograph& field, const SegmentationOptions& o, Segmentation& out) {
  cv::Mat bright = p.smooth > first_threshold(p.smooth, p.seen);
  double scale = o.background_scale;
  for (int pass = 0; pass < 4; ++pass) {
    // Either class may turn out to be the particles. In dense layers the smaller of the two typical widths
    // represents both classes; in sparse layers it represents the particles.
    if (o.background_scale == 0)
      scale = std::clamp(8 * std::min(typical_radius(bright), typical_radius(~bright)), 24.0,
                         0.5 * std::max(field.width, field.height));
    Levels levels;
    if (o.background == Background::morphology) {
      levels = morphological_levels(p.smooth, scale);
    } else {
      const bool flat = o.background == Background::none;
      levels = fit_levels(p.grey, bright, p.seen, std::max(2.0, 3 * out.blur), flat ? 1e5 : scale);
      if (levels.dark.empty() || levels.bright.empty()) fail(field, "has no contrast: no particles found");
      if (flat) levels.dark.setTo(cv::mean(levels.dark)), levels.bright.setTo(cv::mean(levels.bright));
    }
    out.contrast = cv::mean(levels.bright - levels.dark, p.seen)[0];
    if (!(out.contrast > 0)) fail(field, "has no contrast: no particles found");
    p.coverage = normalised(p.grey, levels, 0.1 * out.contrast);
    cv::Mat s = normalised(p.smooth, levels, 0.1 * out.contrast);
    bright = s > 0.5;
    out.blur = edge_blur(s, p.seen, p.sigma);
    if (pass == 3) p.smooth = s;
  }
  out.noise = p.noise / out.contrast;
  // The two fitted levels of pure noise differ by less than a few of its standard deviations.
  if (out.contrast < 6 * p.noise / (2 * std::sqrt(M_PI) * std::max(p.sigma, 0.5)) + 1e-6)
    fail(field, "has no contrast above its noise: no particles found");
}

/// Decides which class the particles are; from here on 1 means inside a particle.
void orient(Pictures& p, const Micrograph& field, const SegmentationOptions& o, Segmentation& out) {
  const double convex = convexity(p.coverage, p.seen);
  out.polarity_score = std::abs(convex);
  out.bright = o.polarity == Polarity::bright || (o.polarity == Polarity::automatic && convex > 0);
  if (o.polarity == Polarity::automatic && std::abs(convex) < 0.05)
    fail(field, "cannot tell whether particles are dark or bright; give --polarity dark or bright");
  if (out.bright) return;
  p.coverage = 1 - p.coverage;
  p.smooth = 1 - p.smooth;
}

/// Fills holes, removes excluded pixels and clips bright reflections. Returns the depth of every pixel in its
/// particle.
cv::Mat clean(Pictures& p, const SegmentationOptions& o, double noise) {
  cv::Mat inside = p.smooth > 0.5;
  if (o.fill_holes) {
    cv::Mat before = inside.clone();
    fill_holes(inside);
    cv::Mat core;
    cv::erode(inside, core, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
    const cv::Mat filled = (core != 0) & (before == 0);
    p.coverage.setTo(1, filled), p.smooth.setTo(1, filled);
  }
  cv::Mat depth = depth_of(inside);
  depth.setTo(0, p.seen == 0);
  p.coverage.setTo(0, p.seen == 0), p.smooth.setTo(0, p.seen == 0);
  // Noise around 0 and 1 averages out in sums; halos and bright reflections are clipped.
  const double beyond = std::max(4 * noise, 0.02);
  p.coverage = cv::min(cv::max(p.coverage, -beyond), 1 + beyond);
  return depth;
}

/// Divides touching particles, and numbers sufficiently large ones starting at 1.
std::vector<int> number_particles(const SegmentationOptions& o, Segmentation& out) {
  const int w = out.width, h = out.height;
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
  return labels;
}

/// Assigns pixels just outside to the nearest particle: they contain the rest of its blurred edge.
void add_bands(std::vector<int>& labels, const cv::Mat& seen, int band) {
  cv::Mat outside(seen.rows, seen.cols, CV_8U), nearest, distance;
  for (size_t i = 0; i < labels.size(); ++i) outside.data[i] = labels[i] ? 0 : 255;
  cv::distanceTransform(outside, distance, nearest, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<int> of(labels.size() + 1);
  for (size_t i = 0; i < labels.size(); ++i)
    if (labels[i]) of[size_t(nearest.ptr<int>()[i])] = labels[i];
  for (size_t i = 0; i < labels.size(); ++i)
    if (!labels[i] && seen.data[i] && distance.ptr<float>()[i] <= float(band))
      labels[i] = of[size_t(nearest.ptr<int>()[i])];
}

}  // namespace

Segmentation segment(const Micrograph& field, const SegmentationOptions& o) {
  Segmentation out;
  out.width = field.width, out.height = field.height;
  Pictures p = read_pictures(field, o);
  even_out(p, field, o, out);
  orient(p, field, o, out);
  out.depth = to_vector(clean(p, o, out.noise));
  out.labels = number_particles(o, out);
  out.band = std::clamp(int(std::ceil(3 * std::hypot(out.blur, 0.3))), 2, 6);
  if (out.count > 0) add_bands(out.labels, p.seen, out.band);
  out.coverage = to_vector(p.coverage), out.smooth = to_vector(p.smooth);
  return out;
}

}  // namespace aureole
