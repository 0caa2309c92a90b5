// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/edge_ledger.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "aureole/core/keyed_random.h"
#include "aureole/math/erf_inverse.h"

namespace aureole {
namespace {

using std::numbers::pi;

using beside::kPassing;
using beside::kReach;
using beside::kSpread;

// Distance, in sigma, from an edge at the segment's endpoint within which other edges are ignored, since they
// interfere with it (`SceneEdges::far_enough`).
constexpr float kIgnored = 7;
/// Depth, in sigma, within which edges remove power from the same light; farther edges act one group after
/// the other.
constexpr double kTogether = 7;
/// Distance, in sigma, within which edges take part in the sampling of directions.
constexpr float kNear = 7;
/// Number of edges beside a segment for each sampled edge, and upper bound of the sampled edges.
constexpr int kPerDraw = 12, kMostDraws = 4;

/// Constants that make separate random streams from a caller's key.
constexpr std::uint32_t kLooked = 0x1b56c4e9u, kLent = 0x68e31da4u;

/// Returns a key for a segment: segments of one path may share `key`, and pieces of a segment share their
/// direction.
std::uint32_t key_of(const LightWay& way, std::uint32_t key) {
  constexpr std::uint64_t kOdd[] = {0x9e3779b97f4a7c15u, 0xbf58476d1ce4e5b9u, 0x94d049bb133111ebu},
                          kOdder[] = {0xd6e8feb86659fd93u, 0xa0761d6478bd642fu, 0xe7037ed1a0b428dbu};
  std::uint64_t bits = key;
  for (int i = 0; i < 3; ++i)
    bits += kOdd[i] * std::bit_cast<std::uint32_t>(way.d[i]) +
            kOdder[i] * std::bit_cast<std::uint32_t>(way.from[i]);
  return std::uint32_t(bits >> 32) ^ std::uint32_t(bits);
}

/// Transforms points to coordinates along a segment, in units of the Gaussian's standard deviation from its
/// origin.
struct View {
  View(const Vec3& origin, const Vec3& along, double deviation)
      : o(origin), z(normalize(Double3(along))), scale(1 / deviation) {
    make_basis(z, x, y);
  }
  Double3 operator()(const Double3& p) const {
    const Double3 v = (p - o) * scale;
    return {dot(v, x), dot(v, y), dot(v, z)};
  }

  Double3 o, x, y, z;
  double scale;
};

/// A piece of an edge beside a segment, in coordinates along the segment, in units of the deviation.
struct Stretch {
  const MeshEdge* edge;
  Double3 from, along;  ///< one end of the edge, and the vector to the other end
  double foot;          ///< point nearest to the segment's line, as a fraction of the edge
  double begin, end;    ///< interval of the edge that lies beside the segment
  double depth;         ///< depth of the nearest point of the piece
  double weight;        ///< approximate integral of G over the piece
};

/// Returns the piece of an edge whose depths lie in [first, last]; its weight is 0 where the edge is not
/// beside the segment.
Stretch stretch_of(const MeshEdge& edge, const View& view, double first, double last) {
  Stretch s{&edge, view(Double3(edge.a)), {}, 0, 0, 1, 0, 0};
  s.along = view(Double3(edge.b)) - s.from;
  const double shown2 = s.along.x * s.along.x + s.along.y * s.along.y;
  if (!(shown2 > 1e-6 * s.along.z * s.along.z)) return s;  // an edge along the segment diffracts nothing
  if (std::abs(s.along.z) > 1e-12) {
    const double t0 = (first - s.from.z) / s.along.z, t1 = (last - s.from.z) / s.along.z;
    s.begin = std::max(s.begin, std::min(t0, t1)), s.end = std::min(s.end, std::max(t0, t1));
  } else if (!(s.from.z >= first && s.from.z <= last)) {
    return s;
  }
  if (!(s.begin < s.end)) return s;
  s.foot = -(s.from.x * s.along.x + s.from.y * s.along.y) / shown2;
  const double nearest = std::clamp(s.foot, s.begin, s.end);
  const double x = s.from.x + nearest * s.along.x, y = s.from.y + nearest * s.along.y, r2 = x * x + y * y;
  if (r2 > kReach * kReach) return s;
  s.depth = s.from.z + nearest * s.along.z;
  s.weight = std::exp(-0.5 * r2) * std::min(1.0, 0.4 * std::sqrt(shown2) * (s.end - s.begin));
  return s;
}

Spectrum power_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d, const SceneEdges::Beams& beams,
                  KeyedRandom& random) {
  if (const auto power = edges.power(x, d, beams)) return *power;
  float u[7];
  for (float& number : u) number = random.next();
  return diffracted_at(edges, x, d, beams, u);
}

/// Returns an estimate of the power that one of the pieces, sampled by its weight, removes; `all` is the sum
/// of the weights.
Spectrum lent_at(const Scene& scene, std::span<const Stretch> stretches, double all, const Vec3& d,
                 double deviation, const SceneEdges::Beams& beams, KeyedRandom& random) {
  double rest = random.next() * all;
  std::size_t i = 0;
  for (; i + 1 < stretches.size() && rest >= stretches[i].weight; ++i) rest -= stretches[i].weight;
  const Stretch& s = stretches[i];
  const double shown = std::hypot(s.along.x, s.along.y);
  const double low = std::erf((s.begin - s.foot) * shown * std::sqrt(0.5)),
               high = std::erf((s.end - s.foot) * shown * std::sqrt(0.5));
  const double at = std::clamp(
      s.foot + sample_between(low, high, random.next()) * std::numbers::sqrt2 / shown, s.begin, s.end);
  const double x = s.from.x + s.foot * s.along.x, y = s.from.y + s.foot * s.along.y;
  // Integral of G over the piece, per length [1/unit of length of the scene].
  const double mass = std::exp(-0.5 * (x * x + y * y)) * 0.5 * (high - low) / std::sqrt(2 * pi) *
                      EdgeLine(*s.edge).length / (shown * deviation * deviation);
  if (!(mass > 0)) return 0.f;
  const EdgePoint point = scene.diffraction()->edges().place_on(*s.edge, at);
  const double per_way = per_open_way(scene.surfaces(), point, d, deviation,
                                      kPassing * scene.diffraction()->edges().widest_beam(), random)
                             .value_or(0);
  if (!(per_way > 0)) return 0.f;
  return power_at(scene.diffraction()->edges(), point, d, beams, random) *
         float(mass * all / s.weight * per_way);
}

/// Returns an estimate of D for the edges at one depth.
Spectrum lent(const Scene& scene, std::span<const Stretch> stretches, const Vec3& d, double deviation,
              const SceneEdges::Beams& beams, KeyedRandom& random) {
  double all = 0;
  for (const Stretch& s : stretches) all += s.weight;
  // Probability of evaluating the edges: Russian roulette where little power can be removed, since S is about
  // half of sigma, and N about half.
  const double probability = std::clamp(2 * all / (std::sqrt(2 * pi) * kSpread), 0.01, 1.0);
  if (random.next() >= probability) return 0.f;
  // Number of samples: S of many edges near one another varies strongly and has both signs.
  const int draws = std::clamp(int(stretches.size()) / kPerDraw, 1, kMostDraws);
  Spectrum sum = 0.f;
  for (int i = 0; i < draws; ++i) sum += lent_at(scene, stretches, all, d, deviation, beams, random);
  return sum * float(1 / (probability * draws));
}

}  // namespace

Spectrum diffracted_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d,
                       const SceneEdges::Beams& beams, std::span<const float, 7> u) {
  // Directions are sampled from the cones of all edges nearby, and from a lobe about the light's direction,
  // into which corners diffract.
  thread_local std::vector<const MeshEdge*> near;
  near.clear();
  const float radius = kNear * beams.widest;
  edges.index().visit_edges({x.x.to_float(), d, radius, -radius, radius},
                            [&](const MeshEdge& edge) { near.push_back(&edge); });
  if (near.empty()) near.push_back(x.edge);
  const auto on = [&](const MeshEdge* edge) {
    EdgePoint point = x;
    point.edge = edge;
    return point;
  };
  constexpr double kLobe = 0.4;
  const double a = 4 * beams.angle, a2 = a * a;
  const float choice = u[0];
  Vec3 out;
  if (choice < kLobe) {
    const double w = u[1] * 4 / (a2 + 4), v = a2 * w / (1 - w);  // the squared difference of the directions
    const double cosine = 1 - 0.5 * v, sine = std::sqrt(std::max(0.0, v * (1 - 0.25 * v))),
                 phi = 2 * pi * u[2];
    const Double3 z = normalize(Double3(d));
    Double3 s, t;
    make_basis(z, s, t);
    out = normalize((z * cosine + s * (sine * std::cos(phi)) + t * (sine * std::sin(phi))).to_float());
  } else {
    const double share = (choice - kLobe) / (1 - kLobe) * double(near.size());
    const auto direction =
        edges.scatter(on(near[std::min(std::size_t(share), near.size() - 1)]), d, beams, &u[1]);
    if (!direction) return 0.f;
    out = direction->d;
  }
  const Double3 turn = Double3(out) - Double3(d);
  const double v = dot(turn, turn);
  double pdf = kLobe * a2 / (pi * (a2 + v) * (a2 + v)) * (a2 + 4) / 4;
  for (const MeshEdge* edge : near)
    pdf += (1 - kLobe) / double(near.size()) * edges.scatter_pdf(on(edge), d, out, beams);
  return edges.kernel(x, d, out, beams, {u[5], u[6]}) * float(1 / pdf);
}

Spectrum left_by_edges(const Scene& scene, const LightWay& way, const Wavelengths& w, std::uint32_t key) {
  if (!scene.diffraction() || !scene.diffraction()->has_edges()) return 1.f;
  const SceneEdges& edges = scene.diffraction()->edges();
  static_assert(kReach * kSpread <= SceneEdges::kMargin);
  const float part = edges.looks_beside();
  if (part < 1 && KeyedRandom(key_of(way, key ^ kLooked)).next() >= part) return 1.f;
  const auto clear = [&](LightWay::End end) {
    return edges.widest_beam() * (end == LightWay::End::edge ? kIgnored : kPassing);
  };
  const float after = clear(way.begin), end = way.length - clear(way.end);
  const float begin = after + edges.free_along(way.from + way.d * after, way.d, end - after);
  if (!(begin < end)) return 1.f;

  KeyedRandom random(key_of(way, key ^ kLent));
  const SceneEdges::Beams beams = edges.beams(w);
  const double deviation = kSpread * beams.widest, first = begin / deviation, last = end / deviation;
  thread_local std::vector<Stretch> stretches;
  stretches.clear();
  const View view(way.from, way.d, deviation);
  edges.index().visit_edges({way.from, way.d, float(kReach * deviation), begin, end},
                            [&](const MeshEdge& edge) {
                              const Stretch s = stretch_of(edge, view, first, last);
                              if (s.weight > 0) stretches.push_back(s);
                            });
  if (stretches.empty()) return 1.f;
  const auto by_depth = [](const Stretch& a, const Stretch& b) { return a.depth < b.depth; };
  const auto [nearest, farthest] = std::minmax_element(stretches.begin(), stretches.end(), by_depth);
  constexpr double kGap = kTogether / kSpread;
  if (farthest->depth - nearest->depth > kGap) std::stable_sort(stretches.begin(), stretches.end(), by_depth);
  Spectrum left = 1.f;
  for (auto from = stretches.begin(); from != stretches.end();) {
    auto to = from + 1;
    while (to != stretches.end() && to->depth - from->depth <= kGap) ++to;
    left *= Spectrum(1.f) - lent(scene, {from, to}, way.d, deviation, beams, random);
    from = to;
  }
  return part < 1 ? Spectrum(1.f) + (left - Spectrum(1.f)) * (1 / part) : left;
}

}  // namespace aureole
