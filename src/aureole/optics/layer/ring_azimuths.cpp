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

RingAzimuths::RingAzimuths(const std::function<double(double, double)>& f, double extent,
                           const Layout& layout, const ParallelFor& parallel_for)
    : layout_(layout) {
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
  const auto fill = [&](int i) {
    const int first = rings_[i].first, bins = int(rings_[i].bins);
    const double a = ring_start(i), b = ring_start(i + 1);
    constexpr int kAcross = 3, kAlong = 3;
    std::vector<double> weights(bins);
    double sum = 0;
    for (int k = 0; k < bins; ++k) {
      for (int m = 0; m < kAlong; ++m) {
        const double p = (k + (m + 0.5) / kAlong) / bins, x = 1 - 2 * p, y = 1 - std::abs(x);
        const double length = std::hypot(x, y);
        for (int r = 0; r < kAcross; ++r) {
          const double u = a + (b - a) * (r + 0.5) / kAcross;
          weights[k] += f(u * x / length, u * y / length) / (length * length);  // d azimuth/dp = 2/length^2
        }
      }
      sum += weights[k];
    }
    // A floor of 1 %: features between the points of the sum keep a positive density.
    const double floor = sum > 0 ? 0.01 * sum / bins : 1.0;
    sum += floor * bins;
    double running = 0;
    for (int k = 0; k < bins; ++k) {
      cdf_[first + k] = float(running / sum);
      running += weights[k] + floor;
    }
    cdf_[first + bins] = 1;
  };
  parallel_for(
      std::size_t(count),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) fill(int(i));
      },
      4);
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
