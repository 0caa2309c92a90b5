// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/diffraction_integral.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

using std::numbers::pi;
using Rule = boost::math::quadrature::gauss<double, 10>;

/// Calls visit(t, weight) for the nodes of Gauss rules between a and b, in cells as wide as `step` allows.
template <class Step, class Visit>
void for_nodes(double a, double b, const Step& step, const Visit& visit) {
  for (double begin = a; begin < b;) {
    double width = std::min(step(begin), b - begin);
    width = std::min(width, step(begin + width));
    // The last cells have equal widths, so that none is a sliver.
    const double cells = std::ceil((b - begin) / width - 1e-9);
    if (cells < 3) width = (b - begin) / cells;
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1})
        visit(begin + 0.5 * width * (1 + side * Rule::abscissa()[k]), 0.5 * width * Rule::weights()[k]);
    if (cells <= 1) break;
    begin += width;
  }
}

struct Wave {
  Complex value, normal_derivative;  // derivative along z
};

/// Returns exp(i k r)/r from the origin at a vector v, r = |v|, and its derivative along z.
Wave spherical(const std::array<double, 3>& v, double k) {
  const double r = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const Complex value = std::polar(1 / r, k * r);
  return {value, v[2] / r * Complex(-1 / r, k) * value};
}

Wave incident(const ScreenSource& s, double x, double y, double k) {
  if (s.is_point) return spherical({x - s.at[0], y - s.at[1], -s.at[2]}, k);
  const Complex value = std::polar(1.0, k * (s.at[0] * x + s.at[1] * y));
  return {value, Complex(0, k * s.at[2]) * value};
}

/// Returns a function for the width of cells: the phase changes by at most about 6 rad in a cell, and a cell
/// is no wider than half the distance to a pole.
auto phase_step(const ScreenSource& source, const std::array<double, 3>& point, double k) {
  return [=](double x, double y) {
    // The slope of the phase along each coordinate: of the wave from the opening to the point, and of the
    // wave from the source.
    const double rx = x - point[0], ry = y - point[1], r = std::sqrt(rx * rx + ry * ry + point[2] * point[2]);
    double slope_x = rx / r, slope_y = ry / r, nearest = r;
    if (source.is_point) {
      const double sx = x - source.at[0], sy = y - source.at[1],
                   s = std::sqrt(sx * sx + sy * sy + source.at[2] * source.at[2]);
      slope_x += sx / s, slope_y += sy / s;
      nearest = std::min(nearest, s);
    } else {
      slope_x += source.at[0], slope_y += source.at[1];
    }
    // Where the slope is 0, the curvature of the phase, 1/nearest, limits the width.
    const double slope = k * (std::max(std::abs(slope_x), std::abs(slope_y)) + 1e-9);
    return std::min({6 / slope, std::sqrt(6 * nearest / k), 0.5 * nearest});
  };
}

void require_behind(const std::array<double, 3>& point, double k) {
  if (!(point[2] > 0))
    throw std::domain_error("point behind a screen: expected z > 0, got " + std::to_string(point[2]));
  if (!(k > 0)) throw std::domain_error("wave number: expected a positive number, got " + std::to_string(k));
}

}  // namespace

FlatOpening FlatOpening::polygon(PolygonRegion region) {
  FlatOpening o;
  o.region_ = std::move(region);
  return o;
}

FlatOpening FlatOpening::disc(double radius, double inner) {
  if (!(inner >= 0 && inner < radius && radius < INFINITY))
    throw std::domain_error("opening: expected 0 <= inner < radius, got " + std::to_string(inner) + " and " +
                            std::to_string(radius));
  FlatOpening o;
  o.radius_ = radius, o.inner_ = inner;
  return o;
}

std::vector<double> FlatOpening::intervals(double y) const {
  std::vector<double> ends;
  if (!region_) {
    const auto half = [y](double r) { return std::sqrt(std::max(0.0, (r - y) * (r + y))); };
    ends = {-half(radius_), half(radius_)};
    if (std::abs(y) < inner_) ends.insert(ends.begin() + 1, {-half(inner_), half(inner_)});
    return ends;
  }
  for (const Ring& ring : region_->rings())
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const PlanePoint a = ring[i], b = ring[(i + 1) % ring.size()];
      if ((a.y <= y) != (b.y <= y)) ends.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
  std::sort(ends.begin(), ends.end());
  return ends;
}

std::complex<double> FlatOpening::integral(const std::function<std::complex<double>(double, double)>& value,
                                           const std::function<double(double, double)>& step) const {
  const auto row = [&](double y) {
    Complex sum = 0;
    const std::vector<double> ends = intervals(y);
    for (std::size_t i = 0; i + 1 < ends.size(); i += 2)
      for_nodes(
          ends[i], ends[i + 1], [&](double x) { return step(x, y); },
          [&](double x, double weight) { sum += weight * value(x, y); });
    return sum;
  };
  // The narrowest step in a row, at its ends and at seven points between, since the step in y may be smallest
  // anywhere in it.
  const auto row_step = [&](double y) {
    double least = INFINITY;
    const std::vector<double> ends = intervals(y);
    for (std::size_t i = 0; i + 1 < ends.size(); i += 2)
      for (int j = 0; j <= 8; ++j)
        least = std::min(least, step(ends[i] + (ends[i + 1] - ends[i]) * j / 8, y));
    return least;
  };
  Complex sum = 0;
  if (!region_) {
    // With y = radius sin(t) the ends of the rows are smooth functions of t; those of a hole are smooth in
    // its own t.
    const auto part = [&](double from, double to, double radius) {
      for_nodes(
          std::asin(std::clamp(from / radius, -1.0, 1.0)), std::asin(std::clamp(to / radius, -1.0, 1.0)),
          [&](double t) { return std::min(0.5, row_step(radius * std::sin(t)) / radius); },
          [&](double t, double weight) { sum += weight * radius * std::cos(t) * row(radius * std::sin(t)); });
    };
    if (inner_ > 0) {
      // Above and below the hole its rim does not cut the rows; beside it the rows' ends are smooth in the
      // hole's own t. Rows just above the hole and just inside it have integrals that join without a jump.
      part(-radius_, -inner_, radius_);
      part(-inner_, inner_, inner_);
      part(inner_, radius_, radius_);
    } else {
      part(-radius_, radius_, radius_);
    }
    return sum;
  }
  std::vector<double> heights;
  for (const Ring& ring : region_->rings())
    for (const PlanePoint& p : ring) heights.push_back(p.y);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
    // Along a slanted side the phase changes with x as well.
    double slant = 1;
    for (const Ring& ring : region_->rings())
      for (std::size_t j = 0; j < ring.size(); ++j) {
        const PlanePoint a = ring[j], b = ring[(j + 1) % ring.size()];
        if (std::min(a.y, b.y) <= heights[i] && std::max(a.y, b.y) >= heights[i + 1])
          slant = std::max(slant, std::abs((b.x - a.x) / (b.y - a.y)));
      }
    for_nodes(
        heights[i], heights[i + 1],
        [&](double y) {
          return row_step(std::clamp(y, heights[i] + 1e-9 * (heights[i + 1] - heights[i]),
                                     heights[i + 1] - 1e-9 * (heights[i + 1] - heights[i]))) /
                 slant;
        },
        [&](double y, double weight) { sum += weight * row(y); });
  }
  return sum;
}

ScreenSource ScreenSource::plane_wave(std::array<double, 3> d) {
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (!(d[2] > 0 && length < INFINITY))
    throw std::domain_error("plane wave: expected a direction with z > 0");
  return {false, {d[0] / length, d[1] / length, d[2] / length}};
}

ScreenSource ScreenSource::point(std::array<double, 3> position) {
  if (!(position[2] < 0))
    throw std::domain_error("point source: expected z < 0, got " + std::to_string(position[2]));
  return {true, position};
}

std::complex<double> rayleigh_sommerfeld(const FlatOpening& opening, const ScreenSource& source,
                                         std::array<double, 3> point, double k) {
  require_behind(point, k);
  const Complex sum = opening.integral(
      [&](double x, double y) {
        // The derivative is taken with respect to z of the point, which is -dG/dz' on the screen.
        return incident(source, x, y, k).value *
               spherical({point[0] - x, point[1] - y, point[2]}, k).normal_derivative;
      },
      phase_step(source, point, k));
  return -sum / (2 * pi);
}

std::complex<double> kirchhoff(const FlatOpening& opening, const ScreenSource& source,
                               std::array<double, 3> point, double k) {
  require_behind(point, k);
  const Complex sum = opening.integral(
      [&](double x, double y) {
        const Wave in = incident(source, x, y, k), out = spherical({point[0] - x, point[1] - y, point[2]}, k);
        return out.value * in.normal_derivative + in.value * out.normal_derivative;
      },
      phase_step(source, point, k));
  return -sum / (4 * pi);
}

std::complex<double> fraunhofer(const FlatOpening& opening, PlanePoint q) {
  const double slope = std::max(std::abs(q.x), std::abs(q.y));
  return opening.integral([&](double x, double y) { return std::polar(1.0, -(q.x * x + q.y * y)); },
                          [&](double, double) { return 6 / (slope + 1e-300); });
}

}  // namespace aureole::optics
