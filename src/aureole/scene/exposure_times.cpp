// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/exposure_times.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace aureole {

ExposureTimes::ExposureTimes(double open, double close, double steady,
                             std::span<const ModulatedPower> modulated) {
  constexpr int kCells = 2048;
  constexpr double kEven = 0.2;
  const auto energy = [&](double from, double to) {
    double sum = steady * (to - from);
    for (const ModulatedPower& m : modulated) sum += m.power * m.modulation->integral(from, to);
    return sum;
  };
  struct Cell {
    double from, to, first, second;  ///< times, and the energy of both halves
    double unevenness() const { return std::abs(first - second); }
    bool operator<(const Cell& o) const { return unevenness() < o.unevenness(); }
  };
  const auto cell = [&](double from, double to) {
    const double middle = 0.5 * (from + to);
    return Cell{from, to, energy(from, middle), energy(middle, to)};
  };
  // Even cells to begin with, since the halves of a periodic light are alike.
  std::priority_queue<Cell> cells;
  constexpr int kFirst = 257;  // a prime number, so that cells and periods do not agree
  const double length = close - open;
  for (int i = 0; i < kFirst; ++i)
    cells.push(cell(open + length * i / kFirst, open + length * (i + 1) / kFirst));
  while (cells.size() < std::size_t(kCells)) {
    const Cell most = cells.top();
    const double middle = 0.5 * (most.from + most.to);
    if (!(most.unevenness() > 0) || !(most.to - most.from > 1e-12 * length)) break;
    cells.pop();
    cells.push(cell(most.from, middle)), cells.push(cell(middle, most.to));
  }
  std::vector<Cell> sorted;
  for (; !cells.empty(); cells.pop()) sorted.push_back(cells.top());
  std::sort(sorted.begin(), sorted.end(), [](const Cell& a, const Cell& b) { return a.from < b.from; });
  double total = 0;
  for (const Cell& c : sorted) total += c.first + c.second;
  edges_.push_back(open), below_.push_back(0);
  double low = 1e300, high = 0;
  for (const Cell& c : sorted) {
    const double even = (c.to - c.from) / length, part = total > 0 ? (c.first + c.second) / total : even;
    edges_.push_back(c.to), below_.push_back(below_.back() + kEven * even + (1 - kEven) * part);
    low = std::min(low, part / even), high = std::max(high, part / even);
  }
  for (double& b : below_) b /= below_.back();
  // Light that goes out, or that is much brighter at times: mild flicker keeps even times, whose weights are all 1.
  is_uneven_ = high > 2.5 * low + 1e-3;
}

double ExposureTimes::cumulative(double time) const {
  const std::size_t k = std::size_t(
      std::clamp<std::ptrdiff_t>(std::upper_bound(edges_.begin(), edges_.end(), time) - edges_.begin(), 1,
                                 std::ptrdiff_t(edges_.size()) - 1));
  const double t = std::clamp((time - edges_[k - 1]) / (edges_[k] - edges_[k - 1]), 0.0, 1.0);
  return std::lerp(below_[k - 1], below_[k], t);
}

ExposureTimes::Sample ExposureTimes::sample(double u, double from, double to) const {
  const double first = cumulative(from), last = cumulative(to), target = std::lerp(first, last, u);
  const std::size_t k = std::size_t(
      std::clamp<std::ptrdiff_t>(std::upper_bound(below_.begin(), below_.end(), target) - below_.begin(), 1,
                                 std::ptrdiff_t(below_.size()) - 1));
  const double part = below_[k] - below_[k - 1], width = edges_[k] - edges_[k - 1];
  const double time = edges_[k - 1] + (part > 0 ? (target - below_[k - 1]) / part : 0.5) * width;
  return {std::clamp(time, from, to), part / width * (to - from) / (last - first)};
}

}  // namespace aureole
