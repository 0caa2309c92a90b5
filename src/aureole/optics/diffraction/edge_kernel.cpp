// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "aureole/optics/diffraction/exponential_integral.h"
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
/// Returns a unit vector perpendicular to `a`, in an arbitrary direction.
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
  // 1/cos(theta/2). The bound keeps it finite for the reversed direction, whose components across are 0.
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
                 fy = edge.from.y - x.y - begin * uy;  // from x to the foot of x on the line
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

/// Weideman's coefficients: w(z) = 1/(sqrt(pi) (L - iz)) + 2/(L - iz)^2 sum a_n Z^n with Z = (L + iz)/(L -
/// iz), a_n being the Fourier coefficients of (L^2 + t^2) exp(-t^2) in the angle 2 atan(t/L).
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

/// Evaluates Faddeeva's function at x + i y, y >= 0, for N groups of arguments, whose sums are interleaved.
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
  // The polynomial is evaluated by Goertzel's recurrence, which needs real products only.
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

/// Factors below exp(-kNegligible) are left out.
constexpr double kNegligible = 20;

double largest(const Lanes& v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
double smallest(const Lanes& v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

template <int N>
void mean_edge_kernels_of(std::span<const ProjectedEdge> edges, double at, double turn, const double* k,
                          const double* sigma, double* result) {
  const ProjectedEdge& own = edges[0];
  const double vx = own.to.x - own.from.x, vy = own.to.y - own.from.y;
  const PlanePoint x{own.from.x + at * vx, own.from.y + at * vy};
  Lanes q[N], inverse[N], along[N], sum[N];  // wave number; 1/(sqrt(8) sigma); beta of an edge along x
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
    // Subtracts the parts of the infinite line beyond the ends of the edge. If the foot of x lies outside the
    // edge, the edge is the difference of the two.
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

/// The factors of the integrand of S that depend on u only, for u in [0, kLargest].
class PowerTable {
public:
  static constexpr double kLargest = 16;
  struct Entry {
    double logarithm, smooth, bend;  ///< exp(-u) times 1, E1(u) + log(u), (1 - exp(-u))/u
  };

  PowerTable() {
    for (int i = 0; i < kSteps + 2; ++i) {
      const double u = i * kLargest / kSteps, e = std::exp(-u);
      entries_[i] = {e, e * (entire_exponential_integral(u) - std::numbers::egamma),
                     i == 0 ? 1 : e * -std::expm1(-u) / u};
    }
  }
  Entry at(double u) const {
    const double x = u * (kSteps / kLargest);
    const int i = int(x);
    const double t = x - i;
    const Entry &a = entries_[i], &b = entries_[i + 1];
    return {a.logarithm + t * (b.logarithm - a.logarithm), a.smooth + t * (b.smooth - a.smooth),
            a.bend + t * (b.bend - a.bend)};
  }

private:
  static constexpr int kSteps = 2048;
  Entry entries_[kSteps + 2];
};
const PowerTable& power_table() {
  static const PowerTable table;
  return table;
}

/// Sums S at a point x over the edges, for up to kMost values of sigma.
class EdgePowerSum {
public:
  static constexpr int kMost = 4;

  /// `normal` is the unit normal of the edge at x.
  EdgePowerSum(PlanePoint x, PlanePoint normal, std::span<const double> sigma)
      : x_(x), normal_(normal), count_(int(sigma.size())) {
    widest_ = 0, narrowest_ = INFINITY;
    for (int i = 0; i < count_; ++i) {
      per_u_[i] = 1 / (8 * sigma[std::size_t(i)] * sigma[std::size_t(i)]),
      log_per_u_[i] = std::log(per_u_[i]);
      widest_ = std::max(widest_, sigma[std::size_t(i)]);
      narrowest_ = std::min(narrowest_, sigma[std::size_t(i)]);
    }
    reach_ = std::sqrt(8 * PowerTable::kLargest) * widest_;
  }

  void add(const ProjectedEdge& edge, bool is_own) {
    const double ex = edge.to.x - edge.from.x, ey = edge.to.y - edge.from.y, length = std::hypot(ex, ey);
    if (!(length > 0)) return;
    Line line;
    line.ux = ex / length, line.uy = ey / length;
    const double from_x = edge.from.x - x_.x, from_y = edge.from.y - x_.y;
    const double begin = from_x * line.ux + from_y * line.uy, end = begin + length;
    line.foot_x = is_own ? 0 : from_x - begin * line.ux, line.foot_y = is_own ? 0 : from_y - begin * line.uy;
    line.off2 = line.foot_x * line.foot_x + line.foot_y * line.foot_y;
    if (line.off2 > reach_ * reach_) return;
    line.parallel = normal_.x * line.uy - normal_.y * line.ux;
    const double nearest = std::clamp(0.0, begin, end);
    double inner = 0;
    if (is_own) {
      inner = kInnermost * narrowest_;
      add_innermost(std::min(inner, -begin));
      add_innermost(std::min(inner, end));
    }
    add_side(line, nearest + inner, end, 1);
    add_side(line, nearest - inner, begin, -1);
  }
  double sum(int i) const { return sum_[i]; }

private:
  struct Line {
    double ux, uy, foot_x, foot_y, off2, parallel;
  };
  /// Half width of the innermost cell, in which only the logarithm is integrated, and largest width of a
  /// cell, in sigma.
  static constexpr double kInnermost = 0.02, kWidest = 1.4;

  void add_innermost(double size) {
    if (!(size > 0)) return;
    for (int i = 0; i < count_; ++i)
      sum_[i] += size * (3 - std::numbers::egamma - std::log(size * size) - log_per_u_[i]);
  }
  /// Adds one side of an edge by cells that grow with the distance from x, up to `reach_`.
  void add_side(const Line& line, double from, double to, double sign) {
    double rest = sign * (to - from);
    while (rest > 0) {
      const double distance = std::sqrt(line.off2 + from * from);
      if (distance > reach_) return;
      double size = std::clamp(distance, kInnermost * narrowest_, kWidest * narrowest_);
      if (rest < 1.5 * size) size = rest;
      constexpr double kAt[] = {0.11270166537925831, 0.5, 0.88729833462074169},
                       kWeight[] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
      for (int i = 0; i < 3; ++i) add_place(line, from + sign * size * kAt[i], size * kWeight[i]);
      from += sign * size, rest -= size;
    }
  }
  void add_place(const Line& line, double s, double weight) {
    const double x = line.foot_x + s * line.ux, y = line.foot_y + s * line.uy, r2 = line.off2 + s * s;
    if (!(r2 > 0)) return;
    const double log_r2 = std::log(r2);
    // Twice the product of the cosines of both normals with r.
    const double both = 2 * (normal_.x * x + normal_.y * y) * (line.uy * x - line.ux * y) / r2;
    for (int i = 0; i < count_; ++i) {
      const double u = r2 * per_u_[i];
      if (u > PowerTable::kLargest) continue;
      const PowerTable::Entry e = table_.at(u);
      sum_[i] += weight * (line.parallel * (e.smooth - e.logarithm * (log_r2 + log_per_u_[i])) +
                           (line.parallel - both) * e.bend);
    }
  }

  const PowerTable& table_ = power_table();
  PlanePoint x_, normal_;
  int count_;
  double widest_, narrowest_, reach_, per_u_[kMost], log_per_u_[kMost], sum_[kMost] = {};
};

}  // namespace

void mean_edge_powers(std::span<const ProjectedEdge> edges, std::size_t index, double at,
                      std::span<const double> k, std::span<const double> sigma, std::span<double> result) {
  const ProjectedEdge& own = edges[index];
  const double vx = own.to.x - own.from.x, vy = own.to.y - own.from.y, shown = std::hypot(vx, vy);
  if (!(shown > 0)) {
    std::fill(result.begin(), result.end(), 0.0);
    return;
  }
  const double sine = shown / own.length, cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
  // S is smooth in sigma: it is evaluated at four values between the smallest and the largest sigma and
  // interpolated by a cubic.
  const auto [least, most] = std::minmax_element(sigma.begin(), sigma.end());
  const bool is_one = *most - *least < 1e-6 * *most;
  double nodes[EdgePowerSum::kMost];
  const std::size_t count = is_one ? 1 : EdgePowerSum::kMost;
  for (std::size_t i = 0; i < count; ++i)
    nodes[i] = is_one ? *most : *least + (*most - *least) * double(i) / double(count - 1);
  EdgePowerSum sum({own.from.x + at * vx, own.from.y + at * vy}, {vy / shown, -vx / shown}, {nodes, count});
  for (std::size_t i = 0; i < edges.size(); ++i) sum.add(edges[i], i == index);
  for (std::size_t i = 0; i < result.size(); ++i) {
    double value = 0;
    for (std::size_t j = 0; j < count; ++j) {
      double basis = 1;
      for (std::size_t l = 0; l < count; ++l)
        if (l != j) basis *= (sigma[i] - nodes[l]) / (nodes[j] - nodes[l]);
      value += basis * sum.sum(int(j));
    }
    result[i] = sine * value / (8 * pi) - cosine / (4 * k[i]);
  }
}

namespace {

/// The factor b of (sigma q)^2 in the removal of the 0th order at a straight edge; (1 - exp(-b 9/4))^2 =
/// 0.991.
constexpr double kStraightRemoval = 2.4;

}  // namespace

void straight_edge_kernels(double across, double along, double shown, std::span<const double> k,
                           std::span<const double> sigma, std::span<double> result) {
  const double across2 = across * across, along2 = along * along;
  if (!(across2 > 0)) {
    std::fill(result.begin(), result.end(), 0.0);
    return;
  }
  const double factor = shown * std::sqrt(8 / pi) / (4 * pi) / across2;
  for (std::size_t i = 0; i < k.size(); i += kLanes) {
    const Lanes width = load_lanes(&sigma[i]), s = load_lanes(&k[i]) * width, s2 = s * s;
    const Lanes left = one_less_exp_minus(kStraightRemoval * across2 * s2);
    store_lanes(&result[i], factor * width * left * left * exp_minus(2 * along2 * s2));
  }
}

namespace {

/// Returns the ratio to sigma of the power of an infinite edge, integrated over the whole plane of q.
double whole_straight_power() {
  static const double power = std::sqrt(kStraightRemoval / pi) * (2 - std::numbers::sqrt2);
  return power;
}

}  // namespace

double straight_edge_power(double cosine, double k, double sigma) {
  // Subtracts the power of wave vectors to which no direction belongs, as in `mean_edge_powers`.
  return whole_straight_power() * std::sqrt(std::max(0.0, 1 - cosine * cosine)) * sigma -
         std::abs(cosine) / (4 * k);
}

void add_straight_edge_corrections(double across, double along, double shown, std::span<const double> weights,
                                   std::span<const double> k, std::span<const double> sigma,
                                   std::span<double> result) {
  const double across2 = across * across, along2 = along * along, turn2 = across2 + along2;
  if (!(across2 > 0)) return;
  const double factor = shown * std::sqrt(8 / pi) / (4 * pi), mean = across2 / (turn2 * turn2);
  for (std::size_t i = 0; i < k.size(); i += kLanes) {
    const Lanes width = load_lanes(&sigma[i]), s = load_lanes(&k[i]) * width, s2 = s * s;
    const Lanes left = one_less_exp_minus(kStraightRemoval * across2 * s2);
    const Lanes more = left * left * (1 / across2) - mean * one_less_exp_minus(2 * turn2 * s2);
    store_lanes(&result[i], load_lanes(&result[i]) +
                                factor * load_lanes(&weights[i]) * width * exp_minus(2 * along2 * s2) * more);
  }
}

double straight_edge_power_correction(double cosine, double sigma) {
  // `mean_edge_powers` of an infinite edge: the integral of exp(-t^2) (E1(t^2) + (1 - exp(-t^2))/t^2).
  static const double mean =
      std::sqrt(1 / (8 * pi)) * 2 * (std::log(1 + std::numbers::sqrt2) + std::numbers::sqrt2 - 1);
  return std::sqrt(std::max(0.0, 1 - cosine * cosine)) * sigma * (whole_straight_power() - mean);
}

void straight_edge_weights(PlanePoint place, double before, double after,
                           std::span<const ProjectedEdge> others, std::span<const double> sigma,
                           std::span<double> weights) {
  constexpr double kLeast = 1e-3, kReach = 7;
  for (std::size_t i = 0; i < sigma.size(); i += kLanes) {
    const Lanes per_scale2 = 1 / (8 * load_lanes(&sigma[i]) * load_lanes(&sigma[i]));
    const auto part = [&](double t) {
      Lanes e = one_less_exp_minus(4 / pi * t * t * per_scale2);
      for (int j = 0; j < kLanes; ++j) e[j] = std::sqrt(e[j]);
      return t < 0 ? -e : e;
    };
    Lanes weight = 0.5 * (part(before) + part(after));
    double largest = 0, widest2 = 0;
    for (int j = 0; j < kLanes; ++j) {
      largest = std::max(largest, weight[j]);
      widest2 = std::max(widest2, sigma[i + std::size_t(j)] * sigma[i + std::size_t(j)]);
    }
    if (largest < kLeast) weight = Lanes{};
    for (std::size_t n = 0; largest >= kLeast && n < others.size(); ++n) {
      const ProjectedEdge& edge = others[n];
      const double ex = edge.to.x - edge.from.x, ey = edge.to.y - edge.from.y, length = std::hypot(ex, ey);
      if (!(length > 0)) continue;
      const double fx = place.x - edge.from.x, fy = place.y - edge.from.y;
      const double foot = (fx * ex + fy * ey) / length, h = (fx * ey - fy * ex) / length;
      if (h * h > kReach * kReach * widest2) continue;
      weight *= 1 - exp_minus(h * h * per_scale2) * 0.5 * (part(length - foot) - part(-foot));
    }
    store_lanes(&weights[i], weight);
  }
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
