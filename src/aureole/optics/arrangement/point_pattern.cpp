// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/point_pattern.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

void check(const std::vector<PointPattern>& fields) {
  if (fields.empty()) throw std::domain_error("no field of points is given");
  for (const PointPattern& f : fields) {
    if (!(f.width > 0 && f.height > 0 && std::isfinite(f.width) && std::isfinite(f.height)))
      throw std::domain_error("a window of points needs positive sides");
    if (f.x.size() != f.y.size() || f.x.size() < 2)
      throw std::domain_error("a window needs two points at least, with an x and a y each");
    for (size_t i = 0; i < f.x.size(); ++i)
      if (!(f.x[i] >= 0 && f.x[i] <= f.width && f.y[i] >= 0 && f.y[i] <= f.height))
        throw std::domain_error("point " + std::to_string(i + 1) + " is outside of its window");
  }
}

double taper(double x, double side) {
  const double s = std::sin(kPi * x / side);
  return s * s;
}

/// Returns the integral of taper(x) exp(-i q x) over the side.
std::complex<double> taper_transform(double q, double side) {
  const double s = std::abs(q) * side / (2 * kPi);
  double value;  // sinc/(1 - s^2), continued through s = 0 and s = 1
  if (s < 1e-6)
    value = 1;
  else if (std::abs(s - 1) < 1e-5)
    value = 1 / (s * (1 + s));
  else
    value = std::sin(kPi * s) / (kPi * s * (1 - s * s));
  return std::polar(0.5 * side * value, -q * side / 2);
}

}  // namespace

double smallest_wave(const PointPattern& window) { return 4 * kPi / std::min(window.width, window.height); }

std::vector<Estimate> window_structure_factor(const std::vector<PointPattern>& fields,
                                              const std::vector<double>& q, int directions) {
  check(fields);
  if (directions < 4) throw std::domain_error("structure factors of windows need four directions at least");
  for (const PointPattern& f : fields)
    for (const double length : q)
      if (!(length >= smallest_wave(f) * (1 - 1e-9)))
        throw std::domain_error("a window of " + std::to_string(f.width) + " x " + std::to_string(f.height) +
                                " says nothing of S below q = " + std::to_string(smallest_wave(f)));
  std::vector<Estimate> result(q.size());
  std::vector<double> weight;
  std::vector<double> independent(q.size(), 0.0), squares(q.size(), 0.0);
  for (const PointPattern& f : fields) {
    double sum = 0, power = 0;
    weight.clear();
    for (size_t i = 0; i < f.x.size(); ++i) {
      weight.push_back(taper(f.x[i], f.width) * taper(f.y[i], f.height));
      sum += weight.back(), power += weight.back() * weight.back();
    }
    if (!(power > 0)) throw std::domain_error("all points of a window lie on its edge");
    const double density = sum / (0.25 * f.width * f.height);
    for (size_t k = 0; k < q.size(); ++k) {
      // Two wave vectors are independent if they are further apart than the bandwidth of the squared taper,
      // 35/18 of 2 pi/side.
      const double bandwidth = 35.0 / 18 * 2 * kPi / std::sqrt(f.width * f.height);
      independent[k] += std::clamp(kPi * q[k] / bandwidth, 1.0, double(directions));
      for (int d = 0; d < directions; ++d) {
        const double angle = kPi * (d + 0.5) / directions;
        const double qx = q[k] * std::cos(angle), qy = q[k] * std::sin(angle);
        double re = 0, im = 0;
        for (size_t i = 0; i < f.x.size(); ++i) {
          const double phase = qx * f.x[i] + qy * f.y[i];
          re += weight[i] * std::cos(phase), im -= weight[i] * std::sin(phase);
        }
        const std::complex<double> mean =
            density * taper_transform(qx, f.width) * taper_transform(qy, f.height);
        const double s = std::norm(std::complex<double>(re, im) - mean) / power;
        result[k].mean += s / (directions * double(fields.size()));
        squares[k] += s * s / (directions * double(fields.size()));
      }
    }
  }
  for (size_t k = 0; k < q.size(); ++k) {
    // With enough independent wave vectors the standard deviation is estimated from the values themselves: in
    // ordered patterns it exceeds the mean.
    const double mean = result[k].mean;
    const double scatter = std::sqrt(std::max(squares[k] - mean * mean, 0.0));
    result[k].error = (independent[k] < 16 ? std::max(mean, scatter) : scatter) / std::sqrt(independent[k]);
  }
  return result;
}

std::vector<Estimate> window_pair_correlation(const std::vector<PointPattern>& fields,
                                              const std::vector<double>& edges, int tiles) {
  check(fields);
  if (edges.size() < 2 || !(edges[0] >= 0) ||
      std::adjacent_find(edges.begin(), edges.end(), [](double a, double b) { return !(a < b); }) !=
          edges.end())
    throw std::domain_error("bins of g(r) need increasing edges, not negative");
  if (tiles < 1 || double(tiles) * tiles * double(fields.size()) < 4)
    throw std::domain_error("the error of g(r) needs four parts of the fields at least");
  for (const PointPattern& f : fields)
    if (!(edges.back() <= 0.5 * std::min(f.width, f.height)))
      throw std::domain_error("g(r) of a window is known up to half of its side only");

  const size_t bins = edges.size() - 1, parts = size_t(tiles) * tiles * fields.size();
  std::vector<double> pairs(parts * bins, 0.0), expected(parts, 0.0);
  for (size_t field = 0; field < fields.size(); ++field) {
    const PointPattern& f = fields[field];
    const size_t n = f.x.size();
    const double area = f.width * f.height;
    for (size_t i = 0; i < n; ++i) {
      const int tx = std::min(int(f.x[i] / f.width * tiles), tiles - 1);
      const int ty = std::min(int(f.y[i] / f.height * tiles), tiles - 1);
      const size_t part = (field * tiles + ty) * tiles + tx;
      expected[part] += double(n - 1) / (area * area);
      for (size_t j = 0; j < n; ++j) {
        const double dx = std::abs(f.x[i] - f.x[j]), dy = std::abs(f.y[i] - f.y[j]);
        const double squared = dx * dx + dy * dy;
        if (i == j || squared >= edges.back() * edges.back()) continue;
        const auto edge = std::upper_bound(edges.begin(), edges.end(), std::sqrt(squared));
        if (edge == edges.begin() || edge == edges.end()) continue;
        // The weight is the fraction of the window in which a pair with this separation can lie.
        pairs[part * bins + size_t(edge - edges.begin()) - 1] += 1 / ((f.width - dx) * (f.height - dy));
      }
    }
  }
  double all_expected = 0;
  for (const double e : expected) all_expected += e;
  std::vector<Estimate> g(bins);
  for (size_t b = 0; b < bins; ++b) {
    const double ring = kPi * (edges[b + 1] * edges[b + 1] - edges[b] * edges[b]);
    double all = 0, mean = 0, squares = 0;
    for (size_t p = 0; p < parts; ++p) all += pairs[p * bins + b];
    g[b].mean = all / (all_expected * ring);
    std::vector<double> without(parts);
    for (size_t p = 0; p < parts; ++p) {
      const double rest = all_expected - expected[p];
      without[p] = rest > 0 ? (all - pairs[p * bins + b]) / (rest * ring) : g[b].mean;
      mean += without[p] / double(parts);
    }
    for (const double w : without) squares += (w - mean) * (w - mean);
    g[b].error = std::sqrt(squares * double(parts - 1) / double(parts));
  }
  return g;
}

}  // namespace aureole::optics
