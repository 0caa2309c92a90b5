// SPDX-License-Identifier: Apache-2.0
// The centre of a corona in an overexposed picture: the light source, and often a ring around it, are one value
// there, so that no pixel is the brightest. A corona is symmetric about its source, however it is clipped.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "aureole/instrument/corona/corona.h"

namespace aureole {
namespace {

using Point = std::array<double, 2>;

/// A picture as logarithms of its brightness up to the value where it is clipped, so that bright and faint rings
/// count alike.
class SymmetryMeasure {
public:
  SymmetryMeasure(const Image& image, double clip, const PictureParts& parts)
      : log_(image.height, image.width),
        clipped_(image.height, image.width),
        used_(image.height, image.width) {
    const size_t channel[3] = {size_t(image.channel("R")), size_t(image.channel("G")),
                               size_t(image.channel("B"))};
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        double sum = 0;
        bool clipped = false;
        for (const size_t c : channel) {
          const double v = image.at(x, y, c);
          clipped |= v >= clip, sum += std::clamp(v, 0.0, clip);
        }
        const bool used = !parts.is_masked(x + 0.5, y + 0.5);
        log_(y, x) = float(std::log(sum / (3 * clip) + 0.01));
        clipped_(y, x) = uchar(clipped && used ? 255 : 0), used_(y, x) = uchar(used);
      }
  }

  const cv::Mat1b& clipped() const { return clipped_; }

  struct Asymmetry {
    double difference;  ///< mean over the pixels whose opposite is in the picture; infinite if they are few
    double visible;     ///< fraction of the pixels whose opposite is in the picture
  };
  /// Compares pixels with those opposite to them, within `radius` pixels of a centre.
  Asymmetry asymmetry(const Point& c, double radius) const {
    const int stride = std::max(1, int(radius / 60));
    double sum = 0;
    int pairs = 0, all = 0;
    for (int y = int(c[1] - radius); y <= int(c[1]); y += stride)
      for (int x = int(c[0] - radius); x <= int(c[0] + radius); x += stride) {
        const double dx = x + 0.5 - c[0], dy = y + 0.5 - c[1];
        if (dx * dx + dy * dy > radius * radius || dy > 0) continue;
        ++all;
        const double ox = c[0] - dx - 0.5, oy = c[1] - dy - 0.5;
        const int i = int(std::floor(ox)), k = int(std::floor(oy));
        if (x < 0 || y < 0 || x >= log_.cols || y >= log_.rows || i < 0 || k < 0 || i + 1 >= log_.cols ||
            k + 1 >= log_.rows || !used_(y, x) || !used_(k, i) || !used_(k + 1, i + 1))
          continue;
        const double s = ox - i, t = oy - k;
        const double opposite = (1 - t) * ((1 - s) * double(log_(k, i)) + s * double(log_(k, i + 1))) +
                                t * ((1 - s) * double(log_(k + 1, i)) + s * double(log_(k + 1, i + 1)));
        // Upper bound of a pixel's difference, so that single objects on one side of the centre count little.
        sum += std::min(std::abs(double(log_(y, x)) - opposite), 1.0);
        ++pairs;
      }
    const double visible = all > 0 ? double(pairs) / all : 0;
    return {visible > 0.25 ? sum / pairs : INFINITY, visible};
  }

private:
  cv::Mat1f log_;
  cv::Mat1b clipped_, used_;
};

/// Returns the circle through points, by least squares of |p|^2 - 2 p.c - (r^2 - c^2) (Kasa, 1976). The radius is
/// 0 if they lie on a line.
std::pair<Point, double> circle_through(const std::vector<cv::Point>& points) {
  cv::Mat a(int(points.size()), 3, CV_64F), b(int(points.size()), 1, CV_64F), x;
  for (int i = 0; i < a.rows; ++i) {
    const double px = points[size_t(i)].x + 0.5, py = points[size_t(i)].y + 0.5;
    a.at<double>(i, 0) = 2 * px, a.at<double>(i, 1) = 2 * py, a.at<double>(i, 2) = 1;
    b.at<double>(i) = px * px + py * py;
  }
  if (!cv::solve(a, b, x, cv::DECOMP_SVD)) return {{0, 0}, 0};
  const double cx = x.at<double>(0), cy = x.at<double>(1), square = x.at<double>(2) + cx * cx + cy * cy;
  return {{cx, cy}, square > 0 ? std::sqrt(square) : 0};
}

}  // namespace

Point corona_centre(const Image& image, double clip, const PictureParts& parts) {
  const Point brightest = brightest_spot(image, parts);
  if (!std::isfinite(clip)) return brightest;
  const SymmetryMeasure measure(image, clip, parts);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(measure.clipped(), outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (outlines.empty()) return brightest;
  const auto largest = std::max_element(outlines.begin(), outlines.end(), [](const auto& a, const auto& b) {
    return cv::contourArea(a) < cv::contourArea(b);
  });
  const double size = std::sqrt(cv::contourArea(*largest) / M_PI);
  // A clipped spot of a few pixels is the light source itself.
  if (size < 3) return brightest;

  // Starting points: the middle of the largest clipped region with all that it surrounds, the centre of the
  // circle along its outline where that is not the border of the picture, and the brightest spot.
  const cv::Moments moments = cv::moments(*largest);
  std::vector<Point> starts{{moments.m10 / moments.m00 + 0.5, moments.m01 / moments.m00 + 0.5}, brightest};
  std::vector<cv::Point> inner;
  for (const cv::Point& p : *largest)
    if (p.x > 0 && p.y > 0 && p.x + 1 < image.width && p.y + 1 < image.height) inner.push_back(p);
  double reach = size;
  if (inner.size() >= 8)
    if (const auto [centre, radius] = circle_through(inner);
        radius > 0 && radius < 2 * std::max(image.width, image.height)) {
      starts.push_back(centre), reach = std::max(reach, radius);
      // Where the picture ends beside the centre, too few pixels have an opposite, and the outline's circle
      // is the better estimate.
      if (measure.asymmetry(centre, radius).visible < 0.7) return centre;
    }

  const double radius = std::min(std::max(2 * reach, 12.0), 0.5 * std::max(image.width, image.height));
  Point best = brightest;
  double least = INFINITY;
  for (Point at : starts) {
    double value = measure.asymmetry(at, radius).difference;
    for (double step = size / 3; step > 0.05;) {
      Point next = at;
      double lower = value;
      for (int i = 0; i < 8; ++i) {
        const double angle = M_PI / 4 * i;
        const Point tried{at[0] + step * std::cos(angle), at[1] + step * std::sin(angle)};
        if (const double v = measure.asymmetry(tried, radius).difference; v < lower) lower = v, next = tried;
      }
      if (lower < value)
        at = next, value = lower;
      else
        step /= 2;
    }
    if (value < least) least = value, best = at;
  }
  return best;
}

}  // namespace aureole
