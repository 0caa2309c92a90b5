// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_group.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aureole::optics {
namespace {

using std::numbers::pi;

/// Four projected edges, by half of their vectors and by their midpoints.
struct SeenEdges {
  Lanes half_x, half_y, middle_x, middle_y;
};

/// Adds the wave of four edges at one wavelength, or of one edge at four: 2 half_y sin(p.half)/(p.half) exp(i
/// p.middle).
inline void add_wave(const Lanes& px, const Lanes& py, const SeenEdges& e, Lanes& re, Lanes& im) {
  Lanes sine, cosine, half_sine, half_cosine;
  const Lanes half = px * e.half_x + py * e.half_y;
  sine_cosine(px * e.middle_x + py * e.middle_y, sine, cosine);
  sine_cosine(half, half_sine, half_cosine);
  const Lanes squared = half * half;
  const Lanes wave = 2 * e.half_y * (squared < 1e-8 ? 1 - squared * (1 / 6.0) : half_sine / half);
  re += wave * cosine, im += wave * sine;
}

double sum(const Lanes& lanes) {
  double sum = 0;
  for (int j = 0; j < kLanes; ++j) sum += lanes[j];
  return sum;
}

/// A change of direction `turn`, and the two standard normal numbers that are s times 2 sigma.
struct DrawnWave {
  PlanePoint normal;
  double turn;
};

// In the functions below seen(i) -> SeenEdges returns the four edges from number 4 i on, for i < fours;
// `share` is the edge's relative power over its length.

template <class Seen>
double kernel_at_one(std::size_t fours, const Seen& seen, DrawnWave drawn, double share, double k,
                     double sigma) {
  const double q = drawn.turn * k, s = 0.5 / sigma;
  const Lanes px = Lanes{} + (q + drawn.normal.x * s), py = Lanes{} + drawn.normal.y * s;
  Lanes re{}, im{};
  for (std::size_t i = 0; i < fours; ++i) add_wave(px, py, seen(i), re, im);
  const double real = sum(re), imaginary = sum(im);
  return share / (4 * pi * pi * drawn.turn * drawn.turn) * -std::expm1(-2 * q * q * sigma * sigma) *
         (real * real + imaginary * imaginary);
}

/// Evaluates the kernel at 4 N wavelengths.
template <int N, class Seen>
void kernels_at_many(std::size_t fours, const Seen& seen, DrawnWave drawn, double share, const double* k,
                     const double* sigma, double* result) {
  Lanes px[N], py[N], exponent[N], re[N], im[N];
  for (int i = 0; i < N; ++i) {
    const Lanes q = drawn.turn * load_lanes(k + i * kLanes), width = load_lanes(sigma + i * kLanes),
                s = 0.5 / width;
    px[i] = q + drawn.normal.x * s, py[i] = drawn.normal.y * s;
    exponent[i] = 2 * q * q * width * width, re[i] = im[i] = Lanes{};
  }
  for (std::size_t i = 0; i < fours; ++i) {
    const SeenEdges edges = seen(i);
    for (int j = 0; j < kLanes; ++j) {
      if (edges.half_y[j] == 0) continue;
      const SeenEdges edge{Lanes{} + edges.half_x[j], Lanes{} + edges.half_y[j], Lanes{} + edges.middle_x[j],
                           Lanes{} + edges.middle_y[j]};
      for (int n = 0; n < N; ++n) add_wave(px[n], py[n], edge, re[n], im[n]);
    }
  }
  const double factor = share / (4 * pi * pi * drawn.turn * drawn.turn);
  for (int i = 0; i < N; ++i) {
    const Lanes chi_less_1 = one_less_exp_minus(exponent[i]);
    store_lanes(result + i * kLanes, factor * chi_less_1 * (re[i] * re[i] + im[i] * im[i]));
  }
}

template <class Seen>
void kernels(std::size_t fours, const Seen& seen, DrawnWave drawn, double share, std::span<const double> k,
             std::span<const double> sigma, std::span<double> result) {
  // If the band is so narrow that all of its waves have the same phases within some hundredths of a radian,
  // one wavelength is computed.
  const auto [longest, shortest] = std::minmax_element(k.begin(), k.end());
  const auto [narrowest, widest] = std::minmax_element(sigma.begin(), sigma.end());
  constexpr double kExtent = 14, kSame = 0.05;
  if ((*shortest - *longest) * drawn.turn * kExtent * *widest < kSame &&
      *widest - *narrowest < 0.1 * kSame * *widest) {
    std::fill(result.begin(), result.end(), kernel_at_one(fours, seen, drawn, share, k[0], sigma[0]));
    return;
  }
  std::size_t i = 0;
  for (; i + 2 * kLanes <= k.size(); i += 2 * kLanes)
    kernels_at_many<2>(fours, seen, drawn, share, &k[i], &sigma[i], &result[i]);
  for (; i + kLanes <= k.size(); i += kLanes)
    kernels_at_many<1>(fours, seen, drawn, share, &k[i], &sigma[i], &result[i]);
}

Lanes dot(const Lanes (&a)[3], SpaceVector b) { return a[0] * b.x + a[1] * b.y + a[2] * b.z; }

}  // namespace

void drawn_edge_kernels(std::span<const ProjectedEdge> edges, std::size_t index, PlanePoint normal,
                        double turn, std::span<const double> k, std::span<const double> sigma,
                        std::span<double> result) {
  // (m.q)^2 of an edge, with q along x: the squared component across q of its projection, over its squared
  // length.
  double own = 0, all = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!(edges[i].length > 0)) continue;
    const double across = (edges[i].to.y - edges[i].from.y) / edges[i].length;
    all += across * across * edges[i].length;
    if (i == index) own = across * across;
  }
  const auto seen = [&](std::size_t four) {
    SeenEdges result{};
    const std::size_t first = four * kLanes;
    for (std::size_t j = 0; j < std::min(std::size_t(kLanes), edges.size() - first); ++j) {
      const ProjectedEdge& edge = edges[first + j];
      result.half_x[j] = 0.5 * (edge.to.x - edge.from.x), result.half_y[j] = 0.5 * (edge.to.y - edge.from.y);
      result.middle_x[j] = edge.from.x + result.half_x[j],
      result.middle_y[j] = edge.from.y + result.half_y[j];
    }
    return result;
  };
  kernels((edges.size() + kLanes - 1) / kLanes, seen, {normal, turn}, own > 0 ? own / all : 0, k, sigma,
          result);
}

EdgeGroup::EdgeGroup(std::span<const Edge> edges) : fours_((edges.size() + kLanes - 1) / kLanes, Four{}) {
  if (edges.empty()) return;
  // Positions are relative to a point of the group: coordinates may be large compared with its size.
  const SpaceVector o = edges[0].a;
  const auto set = [](Lanes(&to)[3], std::size_t lane, double x, double y, double z) {
    to[0][lane] = x, to[1][lane] = y, to[2][lane] = z;
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& [a, b, n0, n1] = edges[i];
    Four& four = fours_[i / kLanes];
    const std::size_t lane = i % kLanes;
    const double x = 0.5 * (b.x - a.x), y = 0.5 * (b.y - a.y), z = 0.5 * (b.z - a.z),
                 length = 2 * std::sqrt(x * x + y * y + z * z);
    set(four.half, lane, x, y, z);
    set(four.middle, lane, a.x - o.x + x, a.y - o.y + y, a.z - o.z + z);
    set(four.n0, lane, n0.x, n0.y, n0.z);
    set(four.n1, lane, n1.x, n1.y, n1.z);
    has_folds_ |= n1.x != 0 || n1.y != 0 || n1.z != 0;
    four.length[lane] = length, four.inverse_length[lane] = length > 0 ? 1 / length : 0;
    length_ += length;
  }
}

[[gnu::always_inline]] inline Lanes EdgeGroup::outline(const Four& four, SpaceVector d) const {
  if (!has_folds_) return Lanes{} + 1;
  return dot(four.n0, d) * dot(four.n1, d) <= 0 ? Lanes{} + 1 : Lanes{};
}

[[gnu::always_inline]] inline Lanes EdgeGroup::light(const Four& four, SpaceVector d, SpaceVector y) const {
  const Lanes across = 2 * outline(four, d) * dot(four.half, y);
  return across * across * four.inverse_length;
}

void EdgeGroup::drawn_kernels(std::size_t index, SpaceVector d, SpaceVector x, PlanePoint normal, double turn,
                              std::span<const double> k, std::span<const double> sigma,
                              std::span<double> result) const {
  const SpaceVector y{d.y * x.z - d.z * x.y, d.z * x.x - d.x * x.z, d.x * x.y - d.y * x.x};
  Lanes sums{};
  for (const Four& four : fours_) sums += light(four, d, y);
  const Four& of_own = fours_[index / kLanes];
  const std::size_t lane = index % kLanes;
  const double own = light(of_own, d, y)[lane] * of_own.inverse_length[lane];
  const auto seen = [&](std::size_t i) {
    const Four& four = fours_[i];
    // The sign tells on which side of the edge the obstacle lies.
    const Lanes side = outline(four, d) * (dot(four.n0, d) < 0 ? Lanes{} + 1 : Lanes{} - 1);
    return SeenEdges{side * dot(four.half, x), side * dot(four.half, y), dot(four.middle, x),
                     dot(four.middle, y)};
  };
  kernels(fours_.size(), seen, {normal, turn}, own > 0 ? own / sum(sums) : 0, k, sigma, result);
}

template <class Weight>
EdgeGroup::Choice EdgeGroup::choose_by(const Weight& weight, double all, double u) const {
  double rest = u * all;
  Choice last{0, 0};
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Lanes weights = weight(fours_[i]);
    const double of_four = sum(weights);
    if (!(of_four > 0)) continue;
    if (rest >= of_four && i + 1 < fours_.size()) {
      rest -= of_four;
      continue;
    }
    for (int j = 0; j < kLanes; ++j) {
      if (!(weights[j] > 0)) continue;
      last = {i * kLanes + std::size_t(j), weights[j] / all};
      if (rest < weights[j]) break;
      rest -= weights[j];
    }
    return last;
  }
  return last;
}

EdgeGroup::Choice EdgeGroup::choose(SpaceVector d, SpaceVector y, double u) const {
  constexpr double kByLength = 0.25;
  Lanes sums{};
  for (const Four& four : fours_) sums += light(four, d, y);
  const double all = sum(sums), of_light = all > 0 ? (1 - kByLength) / all : 0,
               of_length = (all > 0 ? kByLength : 1) / length_;
  return choose_by([&](const Four& four) { return of_light * light(four, d, y) + of_length * four.length; },
                   1, u);
}

std::optional<EdgeGroup::Choice> EdgeGroup::choose_by_length(double u, std::size_t without) const {
  const double out = without == kNone ? 0 : fours_[without / kLanes].length[without % kLanes];
  const double rest = length_ - out;
  if (!(rest > 1e-12 * length_)) return {};
  return choose_by(
      [&](const Four& four) {
        Lanes lengths = four.length;
        if (without != kNone && &four == &fours_[without / kLanes]) lengths[without % kLanes] = 0;
        return lengths;
      },
      rest, u);
}

}  // namespace aureole::optics
