// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/ring_azimuths.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace aureole::optics {
namespace {

constexpr float kFirst = 16, kSecond = 64, kLast = 256;

}  // namespace

double RingAzimuths::ring_start(int i) const {
  const auto at = [&](int part) { return (double(i) - double(starts_[part])) / double(layout_.rings[part]); };
  return i < layout_.rings[0] * kFirst ? at(0) : i < layout_.rings[1] * kSecond + starts_[1] ? at(1) : at(2);
}

RingAzimuths::RingAzimuths(double extent, const Layout& layout) : layout_(layout) {
  starts_[0] = 0;
  starts_[1] = (layout.rings[0] - layout.rings[1]) * kFirst;
  starts_[2] = starts_[1] + (layout.rings[1] - layout.rings[2]) * kSecond;
  const int count = ring_index(std::min(float(extent), std::nextafter(kLast, 0.f))) + 1;
  int total = 0;
  for (int i = 0; i < count; ++i) {
    const double end = ring_start(i + 1);
    const double bins = end * layout.bins[end <= double(kFirst) ? 0 : end <= double(kSecond) ? 1 : 2];
    const int whole = int(std::bit_ceil(unsigned(std::max(16.0, bins))));
    rings_.push_back({total, float(whole)});
    total += whole + 1;
  }
  cdf_.resize(total);
}

RingAzimuths::RingAzimuths(const std::function<double(double, double)>& f, double extent,
                           const Layout& layout, const ParallelFor& parallel_for)
    : RingAzimuths(of(
                       1,
                       [&](std::span<const double> x, std::span<const double> y, std::span<double> values) {
                         for (std::size_t i = 0; i < x.size(); ++i) values[i] = f(x[i], y[i]);
                       },
                       extent, layout, parallel_for)
                       .front()) {}

std::vector<RingAzimuths> RingAzimuths::of(int count, const Intensities& f, double extent,
                                           const Layout& layout, const ParallelFor& parallel_for) {
  std::vector<RingAzimuths> all(std::size_t(count), RingAzimuths(extent, layout));
  const auto fill = [&](int i) {
    const RingAzimuths& any = all.front();
    const int first = any.rings_[i].first, bins = int(any.rings_[i].bins);
    const double a = any.ring_start(i), b = any.ring_start(i + 1);
    constexpr int kAcross = 3, kAlong = 3;
    // `squares` holds the squared lengths of (x, y) at all points of the ring
    std::vector<double> xs, ys, squares;
    for (int k = 0; k < bins; ++k)
      for (int m = 0; m < kAlong; ++m) {
        const double p = (k + (m + 0.5) / kAlong) / bins, x = 1 - 2 * p, y = 1 - std::abs(x);
        const double length = std::hypot(x, y);
        squares.push_back(length * length);
        for (int r = 0; r < kAcross; ++r) {
          const double u = a + (b - a) * (r + 0.5) / kAcross;
          xs.push_back(u * x / length), ys.push_back(u * y / length);
        }
      }
    std::vector<double> values(xs.size() * all.size());
    f(xs, ys, values);
    const double* value = values.data();
    for (RingAzimuths& one : all) {
      std::vector<double> weights(bins);
      double sum = 0;
      for (int k = 0; k < bins; ++k) {
        for (int m = 0; m < kAlong; ++m)
          for (int r = 0; r < kAcross; ++r)
            // weights by the Jacobian d azimuth/dp = 2/length^2
            weights[k] += *value++ / squares[std::size_t(k) * kAlong + m];
        sum += weights[k];
      }
      // Lower bound of the weights, 1 % of the mean, which keeps the density positive for features between
      // the sampled points.
      const double floor = sum > 0 ? 0.01 * sum / bins : 1.0;
      sum += floor * bins;
      double running = 0;
      for (int k = 0; k < bins; ++k) {
        one.cdf_[first + k] = float(running / sum);
        running += weights[k] + floor;
      }
      one.cdf_[first + bins] = 1;
    }
  };
  parallel_for(
      all.front().rings_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) fill(int(i));
      },
      4);
  return all;
}

void RingAzimuths::sample(float u, float xi, float& cosine, float& sine) const {
  const Ring& r = ring(u);
  const bool turned = xi >= 0.5f;
  xi = turned ? 2 * xi - 1 : 2 * xi;
  const float* begin = &cdf_[r.first];
  int bin = 0;
  for (int step = int(r.bins) / 2; step > 0; step /= 2)
    if (begin[bin + step] <= xi) bin += step;
  const float mass = begin[bin + 1] - begin[bin];
  const float p = (float(bin) + (mass > 0 ? std::min((xi - begin[bin]) / mass, 0.9999999f) : 0.5f)) / r.bins;
  float x = 1 - 2 * p, y = 1 - std::abs(x);
  const float scale = (turned ? -1 : 1) / std::sqrt(x * x + y * y);
  cosine = x * scale, sine = y * scale;
}

}  // namespace aureole::optics
