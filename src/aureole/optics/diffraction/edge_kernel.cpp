// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "aureole/optics/faddeeva.h"
#include "aureole/optics/lanes.h"

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
  if (zeroth.removal == ZerothOrder::Removal::edge)
    throw std::logic_error("the waves of edges are summed already: chi of each edge is for edge_field");
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

namespace {

/// Weideman's coefficients: w(z) = 1/(sqrt(pi) (L - iz)) + 2/(L - iz)^2 sum a_n Z^n with Z = (L + iz)/(L - iz), a_n those of the Fourier
/// series of (L^2 + t^2) exp(-t^2) in the angle 2 atan(t/L).
struct FaddeevaSeries {
  static constexpr int kTerms = 24;
  double scale, a[kTerms];

  FaddeevaSeries() : scale(std::sqrt(kTerms / std::numbers::sqrt2)) {
    constexpr int kPoints = 2 * kTerms;
    for (int n = 0; n < kTerms; ++n) {
      double sum = 0;
      for (int j = 1 - kPoints; j < kPoints; ++j) {
        const double angle = j * pi / kPoints, t = scale * std::tan(0.5 * angle);
        sum += (scale * scale + t * t) * std::exp(-t * t) * std::cos((n + 1) * angle);
      }
      a[n] = sum / (2 * kPoints);
    }
  }
};
const FaddeevaSeries kSeries;

/// Faddeeva's function at x + i y, y >= 0, of N groups of arguments: their sums run side by side.
template <int N>
[[gnu::always_inline]] inline void faddeeva_lanes(const Lanes (&x)[N], const Lanes (&y)[N], Lanes (&re)[N],
                                                  Lanes (&im)[N]) {
  const double scale = kSeries.scale;
  Lanes inverse_re[N], inverse_im[N], u[N], v[N], r2[N], b1[N], b2[N];
  for (int i = 0; i < N; ++i) {
    const Lanes ahead = y[i] + scale, inverse = 1.0 / (ahead * ahead + x[i] * x[i]);
    inverse_re[i] = ahead * inverse, inverse_im[i] = x[i] * inverse;
    u[i] = (scale * scale - y[i] * y[i] - x[i] * x[i]) * inverse, v[i] = 2 * scale * x[i] * inverse;
    r2[i] = u[i] * u[i] + v[i] * v[i];
    b1[i] = b2[i] = Lanes{};
  }
  // The polynomial by Goertzel's recurrence, which needs real products only.
  for (int n = FaddeevaSeries::kTerms - 1; n > 0; --n)
    for (int i = 0; i < N; ++i) {
      const Lanes b = 2 * u[i] * b1[i] + (kSeries.a[n] - r2[i] * b2[i]);
      b2[i] = b1[i], b1[i] = b;
    }
  for (int i = 0; i < N; ++i) {
    const Lanes p = 2 * (kSeries.a[0] + u[i] * b1[i] - r2[i] * b2[i]), q = 2 * v[i] * b1[i];
    const Lanes s = p * inverse_re[i] - q * inverse_im[i] + std::numbers::inv_sqrtpi,
                t = p * inverse_im[i] + q * inverse_re[i];
    re[i] = s * inverse_re[i] - t * inverse_im[i], im[i] = s * inverse_im[i] + t * inverse_re[i];
  }
}

/// exp(-20) is left out.
constexpr double kNegligible = 20;

double largest(const Lanes& v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
double smallest(const Lanes& v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

template <int N>
void mean_edge_kernels_of(std::span<const ProjectedEdge> edges, double at, double turn, const double* k,
                          const double* sigma, double* result) {
  const ProjectedEdge& own = edges[0];
  const double vx = own.to.x - own.from.x, vy = own.to.y - own.from.y;
  const PlanePoint x{own.from.x + at * vx, own.from.y + at * vy};
  Lanes q[N], inverse[N], along[N], sum[N];  // wave number, 1/(sqrt(8) sigma), beta of an edge along x
  double widest = 0, narrowest_cone = INFINITY;
  for (int i = 0; i < N; ++i) {
    q[i] = turn * load_lanes(k + i * kLanes);
    const Lanes scale = std::sqrt(8.0) * load_lanes(sigma + i * kLanes);
    inverse[i] = 1.0 / scale, along[i] = 0.5 * q[i] * scale, sum[i] = Lanes{};
    widest = std::max(widest, largest(scale)), narrowest_cone = std::min(narrowest_cone, smallest(along[i]));
  }
  const double reach2 = kNegligible * widest * widest;
  for (const ProjectedEdge& edge : edges) {
    const double ex = edge.to.x - edge.from.x, ey = edge.to.y - edge.from.y, length2 = ex * ex + ey * ey;
    if (!(length2 > 0) || ey == 0) continue;
    const double inverse_length = 1 / std::sqrt(length2), ux = ex * inverse_length, uy = ey * inverse_length;
    const PlanePoint from{edge.from.x - x.x, edge.from.y - x.y}, to{edge.to.x - x.x, edge.to.y - x.y};
    const double begin = from.x * ux + from.y * uy, end = to.x * ux + to.y * uy;
    const double foot_x = from.x - begin * ux, foot_y = from.y - begin * uy,
                 foot2 = foot_x * foot_x + foot_y * foot_y;
    if (foot2 > reach2) continue;
    Lanes line[N] = {};
    bool is_lit = false;
    if (begin < 0 && end > 0 && narrowest_cone * narrowest_cone * ux * ux < kNegligible) {
      is_lit = true;
      for (int i = 0; i < N; ++i) {
        const Lanes beta = along[i] * ux;
        Lanes sine, cosine;
        sine_cosine(q[i] * foot_x, sine, cosine);
        line[i] = 2 * exp_minus(beta * beta + foot2 * inverse[i] * inverse[i]) * cosine;
      }
    }
    // The parts missing beyond its ends; for an edge to one side of x, the difference of the two.
    const auto add_end = [&](const PlanePoint& p, double a, bool is_behind, double sign) {
      const double distance2 = p.x * p.x + p.y * p.y;
      if (distance2 > reach2) return;
      is_lit = true;
      Lanes real[N], imaginary[N], w_re[N], w_im[N];
      for (int i = 0; i < N; ++i) real[i] = along[i] * ux, imaginary[i] = std::abs(a) * inverse[i];
      faddeeva_lanes<N>(real, imaginary, w_re, w_im);
      for (int i = 0; i < N; ++i) {
        Lanes sine, cosine;
        sine_cosine(q[i] * p.x, sine, cosine);
        const Lanes part = is_behind ? cosine * w_re[i] + sine * w_im[i] : cosine * w_re[i] - sine * w_im[i];
        line[i] += sign * exp_minus(distance2 * inverse[i] * inverse[i]) * part;
      }
    };
    add_end(from, begin, begin < 0, begin < 0 ? -1 : 1);
    add_end(to, end, !(end > 0), end > 0 ? -1 : 1);
    if (is_lit)
      for (int i = 0; i < N; ++i) sum[i] += uy * line[i] / inverse[i];
  }
  const double factor = 0.5 * std::sqrt(pi) * vy / (own.length * 4 * pi * pi * turn * turn);
  for (int i = 0; i < N; ++i) {
    const Lanes exponent = along[i] * along[i];  // 2 sigma^2 q^2
    const Lanes chi_less_1 = one_less_exp_minus(exponent);
    store_lanes(result + i * kLanes, factor * chi_less_1 * sum[i]);
  }
}

template <int N>
void drawn_edge_kernels_of(std::span<const ProjectedEdge> edges, PlanePoint normal, double share, double turn,
                           const double* k, const double* sigma, double* result) {
  Lanes px[N], py[N], exponent[N], re[N], im[N];
  for (int i = 0; i < N; ++i) {
    const Lanes q = turn * load_lanes(k + i * kLanes), width = load_lanes(sigma + i * kLanes),
                s = 0.5 / width;
    px[i] = q + normal.x * s, py[i] = normal.y * s;
    exponent[i] = 2 * q * q * width * width, re[i] = im[i] = Lanes{};
  }
  for (const ProjectedEdge& edge : edges) {
    const double ex = 0.5 * (edge.to.x - edge.from.x), ey = 0.5 * (edge.to.y - edge.from.y);
    if (ey == 0) continue;
    const double mx = edge.from.x + ex, my = edge.from.y + ey;
    for (int i = 0; i < N; ++i) {
      Lanes sine, cosine, half_sine, half_cosine;
      const Lanes half = px[i] * ex + py[i] * ey;
      sine_cosine(px[i] * mx + py[i] * my, sine, cosine);
      sine_cosine(half, half_sine, half_cosine);
      const Lanes squared = half * half;
      const Lanes wave = 2 * ey * (squared < 1e-8 ? 1 - squared * (1 / 6.0) : half_sine / half);
      re[i] += wave * cosine, im[i] += wave * sine;
    }
  }
  const double factor = share / (4 * pi * pi * turn * turn);
  for (int i = 0; i < N; ++i) {
    const Lanes chi_less_1 = one_less_exp_minus(exponent[i]);
    store_lanes(result + i * kLanes, factor * chi_less_1 * (re[i] * re[i] + im[i] * im[i]));
  }
}

}  // namespace

void drawn_edge_kernels(std::span<const ProjectedEdge> edges, std::size_t index, PlanePoint normal,
                        double turn, std::span<const double> k, std::span<const double> sigma,
                        std::span<double> result) {
  // Of (m.q)^2, with q along x, the squared part across q of the length that is seen, over the squared length.
  double own = 0, all = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!(edges[i].length > 0)) continue;
    const double across = (edges[i].to.y - edges[i].from.y) / edges[i].length;
    all += across * across * edges[i].length;
    if (i == index) own = across * across;
  }
  const double share = own > 0 ? own / all : 0;
  std::size_t i = 0;
  for (; i + 2 * kLanes <= k.size(); i += 2 * kLanes)
    drawn_edge_kernels_of<2>(edges, normal, share, turn, &k[i], &sigma[i], &result[i]);
  for (; i + kLanes <= k.size(); i += kLanes)
    drawn_edge_kernels_of<1>(edges, normal, share, turn, &k[i], &sigma[i], &result[i]);
}

void mean_edge_kernels(std::span<const ProjectedEdge> edges, double at, double turn,
                       std::span<const double> k, std::span<const double> sigma, std::span<double> result) {
  std::size_t i = 0;
  for (; i + 2 * kLanes <= k.size(); i += 2 * kLanes)
    mean_edge_kernels_of<2>(edges, at, turn, &k[i], &sigma[i], &result[i]);
  for (; i + kLanes <= k.size(); i += kLanes)
    mean_edge_kernels_of<1>(edges, at, turn, &k[i], &sigma[i], &result[i]);
}

}  // namespace aureole::optics
