// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/box_radiosity.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole::optics {

namespace {

/// x atan(y/x), whose limit at x = 0 is 0.
double atan_term(double x, double y) { return x > 0 ? x * std::atan(y / x) : 0; }

/// x ln(y), whose limit at x = y = 0 is 0.
double log_term(double x, double y) { return y > 0 ? x * std::log(y) : 0; }

/// The fourfold integral of a kernel by its antiderivative: the sum over the ends of four intervals, with a sign for each low
/// end.
template <class Antiderivative>
double between_ends(const Interval& a, const Interval& b, const Interval& c, const Interval& d,
                    const Antiderivative& f) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) {
    const auto end = [&](const Interval& v, int bit) { return (i >> bit & 1) != 0 ? v.high : v.low; };
    const bool is_negative = ((i & 1) ^ (i >> 1 & 1) ^ (i >> 2 & 1) ^ (i >> 3 & 1)) != 0;
    const double value = f(end(a, 0), end(b, 1), end(c, 2), end(d, 3));
    sum += is_negative ? -value : value;
  }
  return sum;
}

/// The parts of [0, length] of equal lengths up to `largest`.
std::vector<Interval> parts_of(double length, double largest) {
  const auto count = std::size_t(std::max(1.0, std::ceil(length / largest - 1e-9)));
  std::vector<Interval> parts;
  for (std::size_t i = 0; i < count; ++i)
    parts.push_back({length * double(i) / double(count), length * double(i + 1) / double(count)});
  return parts;
}

double exchange_of(const BoxPatch& p, const BoxPatch& q, const std::array<double, 3>& size) {
  if (p.normal == q.normal)
    return p.side == q.side
               ? 0
               : parallel_exchange(p.first, p.second, q.first, q.second, size[std::size_t(p.normal)]);
  // Intervals along the axis of the other patch's normal count from the edge that both planes share.
  const auto along = [](const BoxPatch& patch, int axis) {
    const int first = patch.normal == 0 ? 1 : 0;
    return axis == first ? patch.first : patch.second;
  };
  const auto from_edge = [&](const BoxPatch& patch, const BoxPatch& other) {
    const Interval v = along(patch, other.normal);
    const double length = size[std::size_t(other.normal)];
    return other.side == 0 ? v : Interval{length - v.high, length - v.low};
  };
  const int shared = 3 - p.normal - q.normal;
  return perpendicular_exchange(from_edge(p, q), along(p, shared), from_edge(q, p), along(q, shared));
}

}  // namespace

double parallel_exchange(Interval x1, Interval y1, Interval x2, Interval y2, double distance) {
  const double z2 = distance * distance;
  return between_ends(x1, y1, x2, y2,
                      [&](double x, double y, double xi, double eta) {
                        const double u = x - xi, v = y - eta;
                        return atan_term(std::sqrt(u * u + z2), v) * v +
                               atan_term(std::sqrt(v * v + z2), u) * u -
                               0.5 * z2 * std::log(u * u + v * v + z2);
                      }) /
         (2 * M_PI);
}

double perpendicular_exchange(Interval x, Interval y1, Interval z, Interval y2) {
  return between_ends(x, y1, z, y2,
                      [&](double a, double y, double b, double eta) {
                        const double v = y - eta, s = a * a + b * b;
                        return atan_term(std::sqrt(s), v) * v - 0.25 * log_term(s - v * v, s + v * v);
                      }) /
         (2 * M_PI);
}

BoxRadiosity BoxRadiosity::of_surfaces(double x, double y, double height) {
  BoxRadiosity box;
  box.surfaces_ = {BoxSurface::floor, BoxSurface::ceiling, BoxSurface::wall};
  const double floor = x * y, walls = 2 * height * (x + y);
  box.areas_ = {floor, floor, walls};
  const double across = parallel_exchange({0, x}, {0, y}, {0, x}, {0, y}, height), to_walls = floor - across;
  box.exchange_ = {0, across, to_walls, across, 0, to_walls, to_walls, to_walls, walls - 2 * to_walls};
  return box;
}

BoxRadiosity BoxRadiosity::of_patches(double x, double y, double height, double largest_side) {
  BoxRadiosity box;
  const std::array<double, 3> size{x, y, height};
  for (std::size_t i = 0; i < 3; ++i) box.parts_[i] = parts_of(size[i], largest_side).size();
  for (const int normal : {2, 0, 1})
    for (const int side : {0, 1})
      for (const Interval& first : parts_of(size[normal == 0 ? 1 : 0], largest_side))
        for (const Interval& second : parts_of(size[normal == 2 ? 1 : 2], largest_side)) {
          box.patches_.push_back({normal != 2 ? BoxSurface::wall
                                  : side == 0 ? BoxSurface::floor
                                              : BoxSurface::ceiling,
                                  normal, side, first, second});
          box.surfaces_.push_back(box.patches_.back().surface);
          box.areas_.push_back(box.patches_.back().area());
        }
  const std::size_t n = box.patches_.size();
  box.exchange_.resize(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      box.exchange_[i * n + j] = box.exchange_[j * n + i] =
          exchange_of(box.patches_[i], box.patches_[j], size);
  return box;
}

std::vector<double> BoxRadiosity::incident(const std::vector<double>& direct,
                                           const std::array<double, 3>& reflectances) const {
  for (const double rho : reflectances)
    if (!(rho >= 0 && rho < 1)) throw std::domain_error("reflectances must be at least 0 and below 1");
  if (direct.size() != size()) throw std::domain_error("each zone needs its direct flux");
  const std::size_t n = size();
  // Reflected flux per unit of area, by which the exchange areas are multiplied.
  std::vector<double> flux = direct, exitance(n);
  const auto reflect = [&](std::size_t i) {
    exitance[i] = reflectances[std::size_t(surfaces_[i])] * flux[i] / areas_[i];
  };
  for (std::size_t i = 0; i < n; ++i) reflect(i);
  // Iterations of Gauss and Seidel, which converge as the sum over orders of reflection does, or faster.
  constexpr int kMostIterations = 10000;
  constexpr double kPrecision = 1e-12;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    double change = 0, sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double now = direct[i];
      for (std::size_t j = 0; j < n; ++j) now += exchange_[i * n + j] * exitance[j];
      change += std::abs(now - flux[i]), sum += now;
      flux[i] = now;
      reflect(i);
    }
    if (!(change > kPrecision * sum)) break;
  }
  return flux;
}

}  // namespace aureole::optics
