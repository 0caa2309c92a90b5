// SPDX-License-Identifier: Apache-2.0
// The transform of a polygon by scan lines: for every y the integral over x is closed, and Gauss's rule adds
// up the rows between the heights of the vertices. Shares nothing with PolygonAperture.
#pragma once

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics::testing {

/// Integral of exp(-i q x) from a to b.
inline std::complex<double> interval_transform(double a, double b, double q) {
  const double h = 0.5 * q * (b - a);
  return std::polar((b - a) * (std::abs(h) < 1e-4 ? 1 - h * h / 6 : std::sin(h) / h), -0.5 * q * (a + b));
}

/// Transform of the points that an odd number of rings surround; rings may cross if `extra_heights` has the
/// heights of the crossings.
inline std::complex<double> scanline_transform(const std::vector<Ring>& rings, double qx, double qy,
                                               const std::vector<double>& extra_heights = {}) {
  std::vector<double> heights = extra_heights;
  double extent = 0;
  for (const Ring& r : rings)
    for (const PlanePoint& p : r) heights.push_back(p.y), extent = std::max(extent, std::hypot(p.x, p.y));
  std::sort(heights.begin(), heights.end());
  std::complex<double> sum = 0;
  const auto row = [&](double y) {
    std::vector<double> crossings;
    for (const Ring& r : rings)
      for (std::size_t i = 0; i < r.size(); ++i) {
        const PlanePoint a = r[i], b = r[(i + 1) % r.size()];
        if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
    std::sort(crossings.begin(), crossings.end());
    std::complex<double> f = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      f += interval_transform(crossings[i], crossings[i + 1], qx);
    return f * std::polar(1.0, -qy * y);
  };
  using Rule = boost::math::quadrature::gauss<double, 20>;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const double height = heights[k + 1] - heights[k];
    if (!(height > 0)) continue;
    double widest = 0;
    for (const Ring& r : rings)
      for (std::size_t i = 0; i < r.size(); ++i) {
        const PlanePoint a = r[i], b = r[(i + 1) % r.size()];
        if (std::min(a.y, b.y) <= heights[k] && std::max(a.y, b.y) >= heights[k + 1])
          widest = std::max(widest, std::abs((b.x - a.x) / (b.y - a.y)) * height);
      }
    const int cells = 1 + int((std::abs(qx) * widest + std::abs(qy) * height) / 4);
    for (int c = 0; c < cells; ++c) {
      const double middle = heights[k] + height * (c + 0.5) / cells, half = 0.5 * height / cells;
      for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
        for (int side : {-1, 1})
          sum += half * Rule::weights()[i] * row(middle + side * half * Rule::abscissa()[i]);
    }
  }
  return sum;
}

inline Ring regular_ring(int n, double radius, double turn = 0, PlanePoint at = {}) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    const double phi = turn + 2 * M_PI * i / n;
    ring.push_back({at.x + radius * std::cos(phi), at.y + radius * std::sin(phi)});
  }
  return ring;
}

/// Directions and lengths of q relative to the shape's size, with edges' normals among them.
inline std::vector<PlanePoint> wave_vectors(double size) {
  std::vector<PlanePoint> all = {{0, 0}};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit;
  for (double u : {1e-12, 1e-6, 1e-3, 0.03, 0.3, 0.9, 0.999, 1.001, 1.1, 3.0, 10.0, 40.0}) {
    for (double phi : {0.0, 0.5 * M_PI, M_PI / 6})
      all.push_back({u * std::cos(phi) / size, u * std::sin(phi) / size});
    const double phi = 2 * M_PI * unit(random);
    all.push_back({u * std::cos(phi) / size, u * std::sin(phi) / size});
  }
  return all;
}

}  // namespace aureole::optics::testing
