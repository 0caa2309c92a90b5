// SPDX-License-Identifier: Apache-2.0
// Importance sampling of directions by the power that single edges diffract: the mixture, over edges, of
// alpha_1^2 and alpha_2^2 with the 0th order removed. Waves of several edges interfere; a sample is weighted
// with the true |F|^2 over this density.
#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/edge_power.h"

namespace aureole::optics {

/// Samples (along, across) in proportion to (1 - chi) alpha_1^2 or (1 - chi) alpha_2^2, exactly and without
/// tables. chi is a Gaussian of standard deviation `sigma` > 0 (0 is allowed only for alpha_1). With v0 =
/// 1/(2 sigma^2), 1/zeta^4 is the integral over v of v exp(-v zeta^2), and chi/zeta^4 that of (v - v0) exp(-v
/// zeta^2) over v > v0; so
///   (1 - chi)/zeta^4 = integral of min(v, v0) exp(-v zeta^2) dv,
/// a mixture in which both coordinates are independent. v and `along` are sampled by rejection: 8 to 13
/// random numbers and 0.3 to 0.5 us per sample on average. `uniform` returns independent numbers in [0, 1).
template <class Uniform>
PlanePoint sample_canonical(bool is_alpha1, double sigma, Uniform&& uniform);

/// The mixture for a set of edges. The caller owns its memory: `shares` has one entry per edge.
class EdgeDensity {
public:
  struct Share {
    EdgePower power;
    double running = 0;  ///< sum of the powers up to and with this edge
  };

  /// `edges` and `shares` must outlive this object. Throws std::domain_error if a power is not finite, as
  /// with ZerothOrder::kept() for an edge whose mean amplitude is not 0. `sample` must not be called if
  /// total() is 0.
  EdgeDensity(std::span<const DiffractingEdge> edges, ZerothOrder zeroth, std::span<Share> shares);

  /// Returns the sum over edges of the power that each diffracts alone.
  double total() const { return shares_.empty() ? 0 : shares_.back().running; }
  /// Returns the density per d2q; its integral over the plane is 1.
  double pdf(PlanePoint q) const;
  template <class Uniform>
  PlanePoint sample(Uniform&& uniform) const;

private:
  std::span<const DiffractingEdge> edges_;
  ZerothOrder zeroth_;
  std::span<const Share> shares_;
};

/// Returns the power that the edges diffract together over the sum of the powers that they diffract alone
/// (Steinberg et al. 2024, S3.2). Near 1 the mixture fits well; below, waves cancel, above, they amplify one
/// another.
double sampling_quality(double diffracted_power, std::span<const DiffractingEdge> edges, ZerothOrder zeroth);

/// Returns edges for an EdgeDensity, with a `sampling_quality` in [0.5, 2] if it can be reached. While the
/// quality is below, the longest edge is halved, up to `most_edges` edges. While it is above, the shortest
/// edge is joined to the shorter of its neighbours, down to one edge per chain. Joined edges that are not
/// collinear have another field: the field is always that of the edges given, which stay as they are.
std::vector<DiffractingEdge> balanced_edges(std::span<const DiffractingEdge> edges, ZerothOrder zeroth,
                                            double diffracted_power, std::size_t most_edges = 4096);

template <class Uniform>
PlanePoint sample_canonical(bool is_alpha1, double sigma, Uniform&& uniform) {
  // Envelopes of the factor of `along`, f(x) = sinc^2(x/2) or ((cos(x/2) - sinc(x/2))/x)^2. For v < v1 the
  // envelope is a peak and a tail of 1/x^2, min(a x^n, b/x^2), without the Gaussian; for v > v1 it is a x^n
  // exp(-v x^2). n is 0 or 2 in both.
  const double peak = is_alpha1 ? 1. / 144 : 1, tail = is_alpha1 ? 1.0634 * 1.0634 : 4;
  const double knee = is_alpha1 ? std::sqrt(std::sqrt(tail / peak)) : 2;  // where peak and tail are equal
  const double low_mass = 2 * (peak * (is_alpha1 ? knee * knee * knee / 3 : knee) + tail / knee);
  const double high_mass = std::sqrt(std::numbers::pi) * (is_alpha1 ? 0.5 * peak : peak);  // times v^-p
  const double p = is_alpha1 ? 1.5 : 0.5;
  const double v1 = std::pow(high_mass / low_mass, 1 / p);
  const double v0 = sigma > 0 ? 0.5 / (sigma * sigma) : INFINITY;

  // The envelope of v consists of powers on three intervals: min(v, v0) v^-3/2 low_mass below v1, and
  // high_mass v^-p above.
  struct Piece {
    double begin, end, factor, exponent;
    double primitive(double v) const {
      return exponent == -1 ? std::log(v) : v == INFINITY ? 0 : std::pow(v, exponent + 1) / (exponent + 1);
    }
    double mass() const { return end > begin ? factor * (primitive(end) - primitive(begin)) : 0; }
  };
  const double first = std::fmin(v0, v1), last = std::fmax(v0, v1);
  const Piece pieces[3] = {
      {0, first, low_mass, -0.5},
      v0 < v1 ? Piece{first, last, v0 * low_mass, -1.5} : Piece{first, last, high_mass, -0.5 - p},
      {last, INFINITY, v0 * high_mass, -1.5 - p}};
  const double masses[3] = {pieces[0].mass(), pieces[1].mass(), last < INFINITY ? pieces[2].mass() : 0};

  const auto log_uniform = [&] { return std::log1p(-uniform()); };
  const auto gauss = [&] {
    return std::sqrt(-2 * log_uniform()) * std::cos(2 * std::numbers::pi * uniform());
  };
  for (;;) {
    double at = (1 - uniform()) * (masses[0] + masses[1] + masses[2]);  // never 0, which would make v 0
    int i = 0;
    while (i < 2 && at >= masses[i]) at -= masses[i++];
    const Piece& piece = pieces[i];
    const double primitive = piece.primitive(piece.begin) + at / piece.factor;
    const double v = piece.exponent == -1
                         ? std::exp(primitive)
                         : std::pow(primitive * (piece.exponent + 1), 1 / (piece.exponent + 1));
    double x, envelope;
    if (v < v1) {
      const double side = uniform() - 0.5, u = 2 * std::abs(side);
      const double inner = 2 * (low_mass / 2 - tail / knee) / low_mass;
      x = u < inner ? knee * (is_alpha1 ? std::cbrt(u / inner) : u / inner) : knee * (1 - inner) / (1 - u);
      envelope = x < knee ? peak * (is_alpha1 ? x * x : 1) : tail / (x * x);
      x = std::copysign(x, side);
      envelope *= std::exp(v * x * x);
    } else {
      x = is_alpha1 ? std::copysign(std::sqrt(-log_uniform() + 0.5 * std::pow(gauss(), 2)), uniform() - 0.5)
                    : gauss() * std::numbers::sqrt2 / 2;
      x /= std::sqrt(v);
      envelope = peak * (is_alpha1 ? x * x : 1);
    }
    // alpha at across = |(x, y)|^2/y is the factor over 2 pi, whatever y is.
    const double factor =
        2 * std::numbers::pi * (is_alpha1 ? edge_alpha1(x, 1) : edge_alpha2(x, 1)) * (x * x + 1);
    if (uniform() * envelope >= factor * factor) continue;
    const double y = std::sqrt((-log_uniform() + 0.5 * std::pow(gauss(), 2)) / v);
    return {x, std::copysign(y, uniform() - 0.5)};
  }
}

template <class Uniform>
PlanePoint EdgeDensity::sample(Uniform&& uniform) const {
  const double at = uniform() * total();
  std::size_t low = 0, high = shares_.size() - 1;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (shares_[middle].running > at)
      high = middle;
    else
      low = middle + 1;
  }
  const EdgePower& power = shares_[low].power;
  const PlanePoint e = edges_[low].vector();
  const double length2 = e.x * e.x + e.y * e.y;
  const PlanePoint zeta = sample_canonical(uniform() * power.total() < power.alpha1,
                                           zeroth_.canonical_sigma(std::sqrt(length2)), uniform);
  // zeta = (q.e, q.m), m = (e_y, -e_x).
  return {(zeta.x * e.x + zeta.y * e.y) / length2, (zeta.x * e.y - zeta.y * e.x) / length2};
}

}  // namespace aureole::optics
