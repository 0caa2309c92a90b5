// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/radial_function.h"

#include <algorithm>
#include <cmath>

namespace aureole::optics {

std::vector<double> RadialFunction::places(int end) {
  std::vector<double> places{0};
  for (int i = 0; i < Cells::count(end); ++i) {
    const double a = Cells::start(i), h = Cells::width(i);
    places.insert(places.end(), {a + h / 3, a + 2 * h / 3, a + h});
  }
  return places;
}

namespace {

std::vector<double> values_at(const std::function<double(double)>& f, std::vector<double> places) {
  for (double& x : places) x = f(x);
  return places;
}

}  // namespace

RadialFunction::RadialFunction(const std::function<double(double)>& f, int end, bool decays)
    : RadialFunction(values_at(f, places(end)), end, decays) {}

RadialFunction::RadialFunction(const std::vector<double>& values, int end, bool decays)
    : end_(float(end)), last_(std::nextafter(float(end), 0.f)) {
  const int cells = Cells::count(end);
  coefficients_.resize(4 * std::size_t(cells) + 4);
  double moment = 0;
  int counted = 0;
  for (int i = 0; i < cells; ++i) {
    const double a = Cells::start(i), *y = &values[3 * std::size_t(i)];
    const double y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3];
    // Coefficients of the cubic through values at 0, 1/3, 2/3 and 1.
    float* k = &coefficients_[4 * std::size_t(i)];
    k[0] = float(y0);
    k[1] = float(-5.5 * y0 + 9 * y1 - 4.5 * y2 + y3);
    k[2] = float(9 * y0 - 22.5 * y1 + 18 * y2 - 4.5 * y3);
    k[3] = float(-4.5 * y0 + 13.5 * y1 - 13.5 * y2 + 4.5 * y3);
    if (a >= end * (15.0 / 16)) moment += y0 * a * a * a, ++counted;
  }
  if (decays && counted > 0) tail_ = float(moment / counted);
}

RadialDistribution::RadialDistribution(const std::function<double(double)>& density, int end, double tail)
    : end_(end) {
  const int cells = Cells::count(end);
  std::vector<double> exact(cells + 1);
  double total = tail / end;
  for (int i = 0; i <= cells; ++i) {
    exact[i] = std::max(density(Cells::start(i)), 0.0);
    if (i > 0) total += 0.5 * (exact[i - 1] + exact[i]) * Cells::width(i - 1);
  }
  exact[cells] = tail / end / end;  // the last value makes the density continuous; the tail keeps its power
  // The cumulative distribution integrates the rounded nodes that `eval` reads, so that samples follow `eval`
  // exactly.
  nodes_.resize(cells + 2);
  power_.resize(cells + 1);
  for (int i = 0; i <= cells; ++i) nodes_[i] = float(exact[i] / total);
  for (int i = 0; i < cells; ++i)
    power_[i + 1] = power_[i] + 0.5 * (double(nodes_[i]) + double(nodes_[i + 1])) * Cells::width(i);
  tail_ = double(nodes_[cells]) * end * end;
  total_ = power_[cells] + tail_ / end;
  guide_.resize(4096);
  for (std::size_t g = 0; g < guide_.size(); ++g) {
    const double target = power_[cells] * double(g) / double(guide_.size());
    const auto first = std::upper_bound(power_.begin(), power_.end(), target) - power_.begin() - 1;
    guide_[g] = std::uint32_t(std::min<std::ptrdiff_t>(first, cells - 1));
  }
}

double RadialDistribution::cdf(double u) const {
  if (!(u > 0)) return 0;
  if (u >= end_) return 1 - tail_ / u / total_;
  double t;
  const int i = Cells::find(u, t);
  const double a = nodes_[i], b = nodes_[i + 1];
  return (power_[i] + Cells::width(i) * t * (a + 0.5 * t * (b - a))) / total_;
}

double RadialDistribution::sample(double xi, double u_max) const {
  const double target = xi * cdf(u_max) * total_, table = power_.back();
  if (!(target > 0)) return 0;
  if (target >= table) return target < total_ ? std::min(tail_ / (total_ - target), u_max) : u_max;
  const std::size_t g = std::min(std::size_t(target / table * double(guide_.size())), guide_.size() - 1);
  int i = int(guide_[g]);
  const int last = int(power_.size()) - 2;
  if (i > 0 && power_[i] > target) --i;  // corrects the rounding of the index into the guide
  while (i < last && power_[i + 1] <= target) ++i;
  // Position t as the root of t (a + t (b - a)/2) = rest, in the form without division by b - a.
  const double a = nodes_[i], b = nodes_[i + 1], rest = (target - power_[i]) / Cells::width(i);
  const double denominator = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * rest));
  const double t = denominator > 0 ? std::min(2 * rest / denominator, 1.0) : 0.0;
  return std::min(Cells::start(i) + t * Cells::width(i), u_max);
}

}  // namespace aureole::optics
