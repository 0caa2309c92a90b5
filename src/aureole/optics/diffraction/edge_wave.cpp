// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_wave.h"

#include <cmath>
#include <numbers>

namespace aureole::optics {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// sin(h)/h, and (cos(h) - sin(h)/h)/h, which is evaluated by its series near 0, where it cancels.
struct Ends {
  double sinc, slope;
};
Ends ends(double h) {
  if (std::abs(h) < 0.1) {
    const double h2 = h * h;
    return {1 - h2 / 6 * (1 - h2 / 20 * (1 - h2 / 42 * (1 - h2 / 72))),
            -h / 3 * (1 - h2 / 10 * (1 - h2 / 28 * (1 - h2 / 54)))};
  }
  const double sinc = std::sin(h) / h;
  return {sinc, (std::cos(h) - sinc) / h};
}

}  // namespace

double edge_alpha1(double along, double across) {
  // (cos(x/2) - sinc(x/2))/x is half of `slope` at x/2.
  return across / (kTwoPi * (along * along + across * across)) * 0.5 * ends(0.5 * along).slope;
}

double edge_alpha2(double along, double across) {
  return across / (kTwoPi * (along * along + across * across)) * ends(0.5 * along).sinc;
}

double DiffractingEdge::length() const { return std::hypot(to.x - from.x, to.y - from.y); }

double ZerothOrder::canonical_sigma(double length) const {
  return removal == Removal::kept ? 0 : removal == Removal::beam ? sigma * length : std::numbers::sqrt3;
}

double ZerothOrder::remainder(double q2, double length) const {
  if (removal == Removal::kept) return 1;
  const double exponent = removal == Removal::beam ? q2 / (2 * sigma * sigma) : q2 * length * length / 6;
  return -std::expm1(-exponent);
}

std::complex<double> edge_wave(const DiffractingEdge& edge, PlanePoint q) {
  const PlanePoint e = edge.vector();
  const double along = q.x * e.x + q.y * e.y, flux = q.x * e.y - q.y * e.x;
  const auto [sinc, slope] = ends(0.5 * along);
  const std::complex<double> wave =
      (edge.a - edge.b) * (0.5 * slope) + std::complex<double>(0, sinc) * edge.mean();
  const double phase = -0.5 * (q.x * (edge.from.x + edge.to.x) + q.y * (edge.from.y + edge.to.y));
  return flux / (q.x * q.x + q.y * q.y) * wave * std::polar(1.0, phase);
}

std::complex<double> edge_field(std::span<const DiffractingEdge> edges, PlanePoint q, ZerothOrder zeroth) {
  const double q2 = q.x * q.x + q.y * q.y;
  if (q2 == 0 && zeroth.removal != ZerothOrder::Removal::kept) return 0;
  std::complex<double> sum = 0;
  if (zeroth.removal == ZerothOrder::Removal::edge) {
    for (const DiffractingEdge& e : edges)
      sum += std::sqrt(zeroth.remainder(q2, e.length())) * edge_wave(e, q);
    return sum;
  }
  for (const DiffractingEdge& e : edges) sum += edge_wave(e, q);
  return std::sqrt(zeroth.remainder(q2, 0)) * sum;
}

std::pair<DiffractingEdge, DiffractingEdge> split(const DiffractingEdge& edge, double t) {
  const PlanePoint middle{edge.from.x + t * (edge.to.x - edge.from.x),
                          edge.from.y + t * (edge.to.y - edge.from.y)};
  const std::complex<double> value = edge.a + t * (edge.b - edge.a);
  return {{edge.from, middle, edge.a, value}, {middle, edge.to, value, edge.b}};
}

DiffractingEdge join(const DiffractingEdge& first, const DiffractingEdge& second) {
  return {first.from, second.to, first.a, second.b};
}

std::vector<DiffractingEdge> region_edges(const PolygonRegion& region, std::complex<double> amplitude) {
  std::vector<DiffractingEdge> edges;
  for (const Ring& ring : region.rings())
    for (std::size_t i = 0; i < ring.size(); ++i)
      edges.push_back({ring[i], ring[(i + 1) % ring.size()], amplitude, amplitude});
  return edges;
}

}  // namespace aureole::optics
