// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_power.h"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/diffraction/exponential_integral.h"

namespace aureole::optics {
namespace {

using std::numbers::pi;

/// E1(u) + ln(u) and (1 - exp(-u))/u, both entire functions, by cubic interpolation: their exact forms take
/// ten times as long.
class PairFunctions {
public:
  PairFunctions() {
    for (int i = 0; i <= kCount + 2; ++i) {
      const double u = double(i - 1) / kPerUnit;
      regular_[i] = entire_exponential_integral(u) - std::numbers::egamma;
      quotient_[i] = u == 0 ? 1 : -std::expm1(-u) / u;
    }
  }
  struct Values {
    double e1, h;
  };
  Values operator()(double u) const {
    if (!(u < kEnd)) return {0, 1 / u};
    const double at = u * kPerUnit;
    const int i = int(at);
    const double t = at - i;
    // Lagrange's cubic through the points i - 1 to i + 2.
    const double a = t + 1, b = t - 1, c = t - 2;
    const double w[4] = {-t * b * c / 6, a * b * c / 2, -a * t * c / 2, a * t * b / 6};
    double regular = 0, quotient = 0;
    for (int k = 0; k < 4; ++k) regular += w[k] * regular_[i + k], quotient += w[k] * quotient_[i + k];
    return {regular - std::log(u), quotient};
  }

private:
  static constexpr int kPerUnit = 32, kEnd = 20, kCount = kPerUnit * kEnd;

  std::array<double, kCount + 3> regular_, quotient_;
};

const PairFunctions& pair_functions() {
  static const PairFunctions functions;
  return functions;
}

struct Node {
  PlanePoint at;
  std::complex<double> weight;  // amplitude times length of the piece
};

/// Calls visit(node) for the nodes of Gauss rules on `pieces` equal pieces of an edge.
template <int kNodes, class Visit>
void for_nodes(const DiffractingEdge& edge, int pieces, const Visit& visit) {
  using Rule = boost::math::quadrature::gauss<double, kNodes>;
  for (int piece = 0; piece < pieces; ++piece)
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1}) {
        const double t = (piece + 0.5 * (1 + side * Rule::abscissa()[k])) / pieces;
        visit(Node{{edge.from.x + t * (edge.to.x - edge.from.x), edge.from.y + t * (edge.to.y - edge.from.y)},
                   (0.5 * Rule::weights()[k] / pieces) * (edge.a + t * (edge.b - edge.a))});
      }
}

template <int kNodes>
double pair_power(const DiffractingEdge& first, const DiffractingEdge& second, double sigma) {
  const PairFunctions& functions = pair_functions();
  const PlanePoint e = first.vector(), f = second.vector();
  const double parallel = e.x * f.x + e.y * f.y;  // also the product of the normals
  const auto pieces = [&](const DiffractingEdge& edge) { return 1 + int(edge.length() * sigma); };
  const int pieces_of_first = pieces(first), pieces_of_second = pieces(second);
  double sum = 0;
  for_nodes<kNodes>(first, pieces_of_first, [&](const Node& p) {
    for_nodes<kNodes>(second, pieces_of_second, [&](const Node& s) {
      const double x = p.at.x - s.at.x, y = p.at.y - s.at.y, r2 = x * x + y * y;
      if (!(r2 > 0)) return;  // the edges cross in a node
      const auto [e1, h] = functions(0.5 * sigma * sigma * r2);
      const double along = (x * e.y - y * e.x) * (x * f.y - y * f.x) / r2;
      sum += (p.weight * std::conj(s.weight)).real() * ((e1 + h) * parallel - 2 * h * along);
    });
  });
  return sum * pi / 2 / (4 * pi * pi);
}

bool same(PlanePoint a, PlanePoint b) { return a.x == b.x && a.y == b.y; }

/// Returns the power of two edges with equal endpoints, where nodes would coincide. `is_reversed`: the second
/// edge runs in the opposite direction.
double coincident_power(const DiffractingEdge& first, const DiffractingEdge& second, bool is_reversed,
                        double sigma) {
  const double length = first.length();
  const EdgeConstants constants = edge_constants(sigma * length);
  const double mean = (first.mean() * std::conj(second.mean())).real() * constants.alpha2,
               slope = ((first.a - first.b) * std::conj(second.a - second.b)).real() * constants.alpha1;
  return length * length * (is_reversed ? slope - mean : slope + mean);
}

template <int kNodes>
double interfering(std::span<const DiffractingEdge> edges, double sigma) {
  double sum = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const DiffractingEdge& first = edges[i];
    if (!(first.length() > 0)) continue;
    sum += edge_power(first, ZerothOrder::of_beam(sigma)).total();
    for (std::size_t j = 0; j < i; ++j) {
      const DiffractingEdge& second = edges[j];
      if (!(second.length() > 0)) continue;
      const bool is_same = same(first.from, second.from) && same(first.to, second.to),
                 is_reversed = same(first.from, second.to) && same(first.to, second.from);
      sum += 2 * (is_same || is_reversed ? coincident_power(first, second, is_reversed, sigma)
                                         : pair_power<kNodes>(first, second, sigma));
    }
  }
  return sum;
}

}  // namespace

EdgeConstants edge_constants(double canonical_sigma) {
  // The integral over zeta is that of interfering_power along one edge of length 1, on which the amplitude is
  // 1 or s in [-1/2, 1/2]: (1/4 pi) times the integral over r in [0, 1] of w(r) (E1(u) + h(u)), with u = c
  // r^2 and w = 1 - r for the constant amplitude, w = 1/12 - r/4 + r^3/6 for the linear one. Below, `moment`
  // holds the integrals for w = 1, r and r^3.
  const double c = 0.5 * canonical_sigma * canonical_sigma;
  if (!(c > 1e-12))
    return {1 / (64 * pi), c > 0 ? (4 - std::numbers::egamma - std::log(c)) / (8 * pi) : INFINITY};
  const double e1 = exponential_integral(c), loss = -std::expm1(-c), root = std::sqrt(c);
  const double gauss0 = std::sqrt(pi) / 2 * std::erf(root) / root, gauss1 = loss / (2 * c);
  double moment[3] = {e1 + 4 * gauss0 - loss / c,
                      0.5 * e1 + gauss1 + (std::numbers::egamma + std::log(c) + e1) / (2 * c), 0};
  if (c > 1e-2) {
    const double gauss3 = (loss - c * std::exp(-c)) / (2 * c * c);
    moment[2] = 0.25 * e1 + 0.5 * gauss3 + (0.5 - gauss1) / c;
  } else {  // a series, since the last two terms cancel
    moment[2] = 0.25 * e1 + 0.375 - c * (1. / 6 - c * (5. / 96 - c / 80));
  }
  return {(moment[0] / 12 - moment[1] / 4 + moment[2] / 6) / (4 * pi), (moment[0] - moment[1]) / (4 * pi)};
}

EdgePower edge_power(const DiffractingEdge& edge, ZerothOrder zeroth) {
  const double length = edge.length(), area = length * length;
  if (!(area > 0)) return {};
  const EdgeConstants constants = edge_constants(zeroth.canonical_sigma(length));
  const double mean = std::norm(edge.mean());
  return {area * std::norm(edge.a - edge.b) * constants.alpha1,
          mean > 0 ? area * mean * constants.alpha2 : 0};
}

double interfering_power(std::span<const DiffractingEdge> edges, double sigma, int nodes) {
  if (!(sigma > 0 && sigma < INFINITY))
    throw std::domain_error("standard deviation of the 0th order: expected a positive number, got " +
                            std::to_string(sigma));
  return nodes <= 2   ? interfering<2>(edges, sigma)
         : nodes <= 4 ? interfering<4>(edges, sigma)
                      : interfering<8>(edges, sigma);
}

double diffracted_power(std::span<const DiffractingEdge> edges, ZerothOrder zeroth, double q_max) {
  if (edges.empty()) return 0;
  PlanePoint low = edges[0].from, high = low;
  bool is_real = true;
  for (const DiffractingEdge& e : edges) {
    for (const PlanePoint& p : {e.from, e.to}) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    is_real = is_real && e.a.imag() == 0 && e.b.imag() == 0;
  }
  const double extent = std::hypot(high.x - low.x, high.y - low.y);
  // Gauss rules along q: a midpoint rule would be inaccurate at the kink of q at 0.
  using Rule = boost::math::quadrature::gauss<double, 10>;
  const int cells = std::max(8, int(std::ceil(q_max * extent * 6 / (2 * pi) / 10)));
  // F(-q) = conj F(q) if amplitudes are real.
  const double turn = is_real ? pi : 2 * pi;
  double sum = 0;
  for (int c = 0; c < cells; ++c)
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1}) {
        const double q = q_max * (c + 0.5 + 0.5 * side * Rule::abscissa()[k]) / cells;
        const int rays = std::max(32, int(std::ceil(q * extent * turn * 6 / (2 * pi))));
        double ring = 0;
        for (int j = 0; j < rays; ++j) {
          const double phi = turn * (j + 0.5) / rays;
          ring += std::norm(edge_field(edges, {q * std::cos(phi), q * std::sin(phi)}, zeroth));
        }
        sum += 0.5 * Rule::weights()[k] * ring / rays * q;
      }
  return sum * q_max / cells / (2 * pi);
}

double zeroth_order_power(std::span<const LinearTriangle> triangles, double sigma) {
  const AmplitudeMoments m = amplitude_moments(triangles);
  if (!(std::norm(m.total) > 0))
    throw std::domain_error("power of the 0th order: the amplitude's integral is 0");
  const std::complex<double> x = m.x / m.total, y = m.y / m.total;
  const double s = 1 / (sigma * sigma);
  const double xx = 2 * ((m.xx / m.total).real() - std::norm(x)) + s,
               yy = 2 * ((m.yy / m.total).real() - std::norm(y)) + s,
               xy = 2 * ((m.xy / m.total).real() - (x * std::conj(y)).real());
  return std::norm(m.total) / (2 * pi * std::sqrt(xx * yy - xy * xy));
}

double mean_edge_sigma(std::span<const DiffractingEdge> edges) {
  double weight = 0, sum = 0;
  for (const DiffractingEdge& e : edges) {
    const double power = edge_power(e, ZerothOrder::of_edges()).total();
    weight += power;
    sum += power * e.length();
  }
  if (!(sum > 0))
    throw std::domain_error("mean length of edges: expected an edge of positive length that is lit");
  return std::numbers::sqrt3 * weight / sum;
}

}  // namespace aureole::optics
