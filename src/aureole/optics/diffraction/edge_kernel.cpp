// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/faddeeva.h"

namespace aureole::optics {
namespace {

using std::numbers::pi;

double dot(SpaceVector a, SpaceVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SpaceVector cross(SpaceVector a, SpaceVector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SpaceVector scaled(SpaceVector a, double s) { return {a.x * s, a.y * s, a.z * s}; }
SpaceVector normalised(SpaceVector a) { return scaled(a, 1 / std::sqrt(dot(a, a))); }
/// Any unit vector across `a`.
SpaceVector across(SpaceVector a) {
  return normalised(std::abs(a.x) < std::abs(a.y) ? cross(a, {1, 0, 0}) : cross(a, {0, 1, 0}));
}

double square(PlanePoint q) { return q.x * q.x + q.y * q.y; }

}  // namespace

DirectionMap::DirectionMap(SpaceVector along, double k)
    : x_(across(along)), y_(cross(along, x_)), z_(along), k_(k) {}

PlanePoint DirectionMap::project(SpaceVector v) const { return {dot(v, x_), dot(v, y_)}; }

std::optional<SpaceVector> DirectionMap::direction(PlanePoint q) const {
  const double half2 = square(q) / (4 * k_ * k_);  // sin^2(theta/2)
  if (!(half2 < 1)) return std::nullopt;
  const double scale = std::sqrt(1 - half2) / k_, cosine = 1 - 2 * half2;
  const double x = q.x * scale, y = q.y * scale;
  return SpaceVector{x * x_.x + y * y_.x + cosine * z_.x, x * x_.y + y * y_.y + cosine * z_.y,
                     x * x_.z + y * y_.z + cosine * z_.z};
}

PlanePoint DirectionMap::wave_vector(SpaceVector direction) const {
  // 1/cos(theta/2), finite but straight back, where no direction across is left either.
  const double scale = k_ / std::sqrt(std::max(0.5 * (1 + dot(direction, z_)), 1e-300));
  return {dot(direction, x_) * scale, dot(direction, y_) * scale};
}

ScatteringPlane::ScatteringPlane(SpaceVector d_i, SpaceVector d_o, double k) {
  const SpaceVector turn{d_o.x - d_i.x, d_o.y - d_i.y, d_o.z - d_i.z},
      mean{d_o.x + d_i.x, d_o.y + d_i.y, d_o.z + d_i.z};
  const double turn_length = std::sqrt(dot(turn, turn)), mean_length = std::sqrt(dot(mean, mean));
  q_ = k * turn_length;
  cosine_ = 0.5 * mean_length;
  if (turn_length < 1e-12) {
    x_ = across(d_i);
    y_ = cross(d_i, x_);
  } else if (mean_length < 1e-12) {
    x_ = scaled(turn, 1 / turn_length);
    y_ = across(x_);
  } else {
    x_ = scaled(turn, 1 / turn_length);
    y_ = cross(scaled(mean, 1 / mean_length), x_);
  }
}

PlanePoint ScatteringPlane::project(SpaceVector v) const { return {dot(v, x_), dot(v, y_)}; }

EdgeWaves edge_waves(std::span<const DiffractingEdge> edges, PlanePoint q, std::span<double> squares) {
  EdgeWaves waves;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::complex<double> wave = edge_wave(edges[i], q);
    waves.field += wave;
    squares[i] = std::norm(wave);
    waves.squares += squares[i];
  }
  return waves;
}

double diffracted_intensity(const EdgeWaves& waves, PlanePoint q, double k, ZerothOrder zeroth) {
  return k * k / (4 * pi * pi) * zeroth.remainder(square(q), 0) * std::norm(waves.field);
}

double mean_edge_kernel(std::span<const ProjectedEdge> edges, std::size_t index, double at, PlanePoint q,
                        double k, double sigma) {
  const ProjectedEdge& own = edges[index];
  const double q2 = square(q);
  if (!(q2 > 0)) return 0;
  const double vx = own.to.x - own.from.x, vy = own.to.y - own.from.y;
  const PlanePoint x{own.from.x + at * vx, own.from.y + at * vy};
  const double scale = std::sqrt(8.0) * sigma;
  double sum = 0;
  for (const ProjectedEdge& edge : edges) {
    const double ex = edge.to.x - edge.from.x, ey = edge.to.y - edge.from.y, length = std::hypot(ex, ey);
    if (!(length > 0)) continue;
    const double ux = ex / length, uy = ey / length;
    const double begin = (edge.from.x - x.x) * ux + (edge.from.y - x.y) * uy;
    const double fx = edge.from.x - x.x - begin * ux,
                 fy = edge.from.y - x.y - begin * uy;  // to the foot of x
    const double decay = (fx * fx + fy * fy) / (scale * scale);
    if (decay > 40) continue;
    const std::complex<double> line = scale * gaussian_wave_integral(begin / scale, (begin + length) / scale,
                                                                     0.5 * scale * (q.x * ux + q.y * uy));
    const double flux = q.x * uy - q.y * ux;
    sum += flux * std::exp(-decay) * (line * std::polar(1.0, q.x * fx + q.y * fy)).real();
  }
  const double flux = (q.x * vy - q.y * vx) / own.length;
  // chi of a beam of this sigma: exp(-2 sigma^2 q^2).
  return k * k / (4 * pi * pi) * -std::expm1(-2 * sigma * sigma * q2) / (q2 * q2) * flux * sum;
}

}  // namespace aureole::optics
