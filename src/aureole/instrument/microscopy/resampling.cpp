// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/resampling.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

constexpr int kOnsetBins = 160;

}  // namespace

SizeMoments sizes_of(std::vector<std::pair<double, double>> radius_weight) {
  SizeMoments s;
  double sum = 0, log_mean = 0;
  for (const auto& [r, w] : radius_weight) sum += w, s.mean += w * r, log_mean += w * std::log(r);
  if (!(sum > 0)) return s;
  s.mean /= sum, log_mean /= sum;
  for (const auto& [r, w] : radius_weight) {
    s.deviation += w * (r - s.mean) * (r - s.mean);
    s.log_deviation += w * (std::log(r) - log_mean) * (std::log(r) - log_mean);
  }
  const double unbiased =
      radius_weight.size() > 1 ? double(radius_weight.size()) / double(radius_weight.size() - 1) : 1;
  s.deviation = std::sqrt(s.deviation / sum * unbiased);
  s.log_deviation = std::sqrt(s.log_deviation / sum * unbiased);
  std::sort(radius_weight.begin(), radius_weight.end());
  for (size_t q = 0; q < std::size(kQuantiles); ++q) {
    // Interpolates linearly between the centres of the steps.
    double before = 0, last_at = 0, last_r = radius_weight.front().first;
    s.quantiles[q] = radius_weight.back().first;
    for (const auto& [r, w] : radius_weight) {
      const double at = (before + 0.5 * w) / sum;
      if (at >= kQuantiles[q]) {
        s.quantiles[q] =
            at > last_at ? last_r + (kQuantiles[q] - last_at) / (at - last_at) * (r - last_r) : r;
        break;
      }
      before += w, last_at = at, last_r = r;
    }
  }
  return s;
}

BlockEstimator::BlockEstimator(const Microstructure& m, const std::vector<Block>& blocks,
                               const std::vector<PointField>& points, double radius_deviation)
    : m_(m), blocks_(blocks), points_(points) {
  std::vector<double> nearest;
  for (const PointField& f : points)
    for (const double d : nearest_distances(f)) nearest.push_back(d);
  std::sort(nearest.begin(), nearest.end());
  if (nearest.empty()) return;
  smallest_ = nearest.front();
  // A few false neighbours (particles divided by mistake) must not determine the scale.
  guess_ = nearest[nearest.size() / 20];
  expected_width_ = std::clamp(std::sqrt(2.0) * radius_deviation, 0.004 * guess_, 0.25 * guess_);
  onset_pairs_ = count_pairs(points, 1.6 * guess_ / kOnsetBins, kOnsetBins);
  double near = 0;
  for (int i = 0; i < kOnsetBins; ++i) {
    distance_.push_back((i + 0.5) * onset_pairs_.width);
    if (distance_.back() > 0.8 * guess_ && distance_.back() < 1.25 * guess_)
      near += onset_pairs_.count[size_t(i)];
  }
  fits_ = near >= 40;
}

Onset BlockEstimator::onset(const std::vector<int>& draw) const {
  if (!fits_) return {smallest_, 0, 0};
  const std::vector<double> g = pair_correlation(onset_pairs_, draw);
  std::vector<double> r, v, n;
  for (size_t i = 0; i < g.size(); ++i)
    if (distance_[i] > 0.5 * guess_)
      r.push_back(distance_[i]), v.push_back(g[i]), n.push_back(onset_pairs_.count[i]);
  return fit_onset(r, v, n, guess_, expected_width_);
}

BlockSample BlockEstimator::sample(const std::vector<int>& draw) const {
  BlockSample s;
  double window = 0, covered = 0;
  std::vector<std::pair<double, double>> sizes;
  for (const int b : draw) {
    const Block& block = blocks_[size_t(b)];
    window += block.window, covered += block.covered;
    for (const int i : block.particles) {
      const Particle& p = m_.particles[size_t(i)];
      sizes.emplace_back(p.radius * m_.fields[size_t(p.field)].pixel_m, m_.weights[size_t(i)]);
    }
  }
  s.covered = window > 0 ? covered / window : 0;
  s.density = density(draw);
  s.onset = has_pairs() ? onset(draw).distance : 0;
  s.sizes = sizes_of(std::move(sizes));
  if (!pairs_.weighted.empty()) s.g = pair_correlation(pairs_, draw);
  return s;
}

double BlockEstimator::density(const std::vector<int>& draw) const {
  double n = 0, area = 0;
  for (const int b : draw) n += blocks_[size_t(b)].centres, area += blocks_[size_t(b)].area;
  return area > 0 ? n / area : 0;
}

std::vector<double> BlockEstimator::pair_correlation(const PairCounts& pairs,
                                                     const std::vector<int>& draw) const {
  const double rho = density(draw);
  std::vector<double> g(pairs.count.size());
  for (const int b : draw)
    for (size_t i = 0; i < g.size(); ++i) g[i] += pairs.weighted[size_t(b)][i];
  for (size_t i = 0; i < g.size(); ++i) {
    const double ring = M_PI * pairs.width * pairs.width * (2 * double(i) + 1);
    g[i] = rho > 0 ? g[i] / (rho * rho * ring) : 0;
  }
  return g;
}

double spread(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const auto at = [&](double q) { return v[std::min(size_t(q * double(v.size())), v.size() - 1)]; };
  return 0.5 * (at(0.8413) - at(0.1587));
}

}  // namespace aureole
