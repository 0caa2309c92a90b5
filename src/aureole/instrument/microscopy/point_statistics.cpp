// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/point_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "aureole/math/simplex.h"

namespace aureole {
namespace {

/// Points sorted into square cells, to find neighbours within one cell's side.
class Cells {
public:
  Cells(const PointField& f, double side) : f_(f), side_(side) {
    for (size_t i = 0; i < f.x.size(); ++i) cells_[key(cell(f.x[i]), cell(f.y[i]))].push_back(int(i));
  }
  template <class Visit>
  void near(double x, double y, const Visit& visit) const {
    const int cx = cell(x), cy = cell(y);
    for (int j = cy - 1; j <= cy + 1; ++j)
      for (int i = cx - 1; i <= cx + 1; ++i)
        if (const auto found = cells_.find(key(i, j)); found != cells_.end())
          for (const int k : found->second) visit(k);
  }

private:
  int cell(double v) const { return int(std::floor(v / side_)); }
  static long long key(int i, int j) { return (static_cast<long long>(j) << 32) + i; }
  const PointField& f_;
  double side_;
  std::unordered_map<long long, std::vector<int>> cells_;
};

}  // namespace

PairCounts count_pairs(const std::vector<PointField>& fields, double width, int bins) {
  PairCounts out;
  out.width = width;
  out.count.assign(size_t(bins), 0);
  size_t first = 0;
  double area = 0;
  for (const PointField& f : fields) area += f.area;
  for (const PointField& f : fields) {
    out.weighted.resize(first + size_t(f.blocks), std::vector<double>(size_t(bins), 0));
    const Cells cells(f, width * bins);
    for (size_t i = 0; i < f.x.size(); ++i)
      cells.near(f.x[i], f.y[i], [&](int j) {
        if (size_t(j) <= i) return;
        const double dx = f.x[size_t(j)] - f.x[i], dy = f.y[size_t(j)] - f.y[i];
        const double at = std::hypot(dx, dy) / width;
        if (!(at < bins)) return;
        const double covariance = f.covariance(dx, dy);
        if (!(covariance > 1e-3 * f.area)) return;
        const double weight = f.area / area / covariance;
        out.weighted[first + size_t(f.block[i])][size_t(at)] += weight;
        out.weighted[first + size_t(f.block[size_t(j)])][size_t(at)] += weight;
        out.count[size_t(at)] += 1;
      });
    first += size_t(f.blocks);
  }
  return out;
}

Onset fit_onset(const std::vector<double>& r, const std::vector<double>& g, const std::vector<double>& count,
                double guess, double expected_width) {
  // Sums for the fit of g(r) = step((r - d)/w) (far + near exp(-(r - d)/l)), with far and near by linear
  // least squares.
  double far = 0, near = 0, pairs = 0, exposure = 0;
  for (size_t i = 0; i < r.size(); ++i) pairs += count[i], exposure += g[i] * r[i];
  const double per_radius = exposure > 0 ? pairs / exposure : 0;  // pairs of a bin = per_radius r g(r)
  // Weights from Poisson errors; an empty bin has the error of a single pair.
  std::vector<double> weight;
  for (size_t i = 0; i < r.size(); ++i)
    weight.push_back(per_radius * r[i] * per_radius * r[i] / (count[i] + 1));
  const auto misfit = [&](const std::array<double, 3>& p) {
    const double d = p[0], w = std::exp(p[1]), l = std::exp(p[2]);
    if (!(d > 0.5 * guess && d < 1.5 * guess && w < 0.3 * guess && w > 1e-4 * guess && l > 0.02 * guess &&
          l < 2 * guess))
      return std::numeric_limits<double>::infinity();
    double a = 0, b = 0, c = 0, u = 0, v = 0, yy = 0;
    const double inverse = 1 / (w * std::sqrt(2.0));
    for (size_t i = 0; i < r.size(); ++i) {
      yy += weight[i] * g[i] * g[i];
      const double x = (r[i] - d) * inverse;
      // below x = -6 the step is below 1e-16, and beyond x = 6 it is 1 to that precision
      if (x < -6) continue;
      const double step = x > 6 ? 1 : 0.5 * std::erfc(-x);
      const double e = r[i] > d ? step * std::exp((d - r[i]) / l) : step;
      const double weighted_step = weight[i] * step, weighted_e = weight[i] * e;
      a += weighted_step * step, b += weighted_step * e, c += weighted_e * e;
      u += weighted_step * g[i], v += weighted_e * g[i];
    }
    const double determinant = a * c - b * b;
    near = determinant > 1e-9 * a * c ? (a * v - b * u) / determinant : 0;
    far = a > 0 ? (u - near * b) / a : 0;
    if (far < 0 && c > 0) far = 0, near = v / c;
    // Weak priors for few pairs: the width of the step is near the spread of radii, and g(r) decays within
    // some tenths of the distance (0.15 to 0.3 for hard discs).
    const auto prior = [](double log_ratio) { return log_ratio * log_ratio / 0.5; };
    return yy - far * u - near * v + prior(p[1] - std::log(expected_width)) +
           prior(p[2] - std::log(0.25 * guess));
  };
  Onset best;
  double least = std::numeric_limits<double>::infinity();
  for (const double width : {0.01, 0.05, 0.15}) {
    const auto found = simplex_minimum<3>(misfit, {guess, std::log(width * guess), std::log(0.25 * guess)},
                                          {0.03 * guess, 0.7, 0.7}, 200);
    if (const double m = misfit(found); m < least) {
      least = m;
      best = {found[0], std::exp(found[1]), far + near};
    }
  }
  return best;
}

std::vector<double> nearest_distances(const PointField& f) {
  std::vector<double> out;
  if (f.x.size() < 2) return out;
  // Cells of about four points; if they contain no neighbour, all points are searched.
  const Cells cells(f, std::max(2 * std::sqrt(f.area / double(f.x.size())), 1e-9));
  for (size_t i = 0; i < f.x.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    const auto visit = [&](int j) {
      if (size_t(j) != i)
        least = std::min(least, std::hypot(f.x[size_t(j)] - f.x[i], f.y[size_t(j)] - f.y[i]));
    };
    cells.near(f.x[i], f.y[i], visit);
    if (!std::isfinite(least))
      for (size_t j = 0; j < f.x.size(); ++j) visit(int(j));
    out.push_back(least);
  }
  return out;
}

}  // namespace aureole
