// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/edge_ledger.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "aureole/math/erf_inverse.h"
#include "aureole/transport/keyed_random.h"

namespace aureole {
namespace {

using std::numbers::pi;

/// Standard deviation of G over the widest sigma. A beam that reaches y is centred within sigma of it, and reaches an edge within sigma
/// of its centre.
constexpr double kSpread = std::numbers::sqrt2;
// In these deviations:
/// Beyond this distance across the light G counts as 0 (4e-6 of it).
constexpr double kReach = 5;
/// Edges and faces at a greater distance along the light do not share it. Surfaces in grazing light, up to 70 degrees, lie within as far
/// as most of G.
constexpr double kDepth = 3;
/// Edges nearer than that, in sigma, are looked at where directions are chosen.
constexpr float kNear = 7;
/// Rays that look for a lit face beside an edge, at most. Of wires that are met less often the estimate is cut.
constexpr int kMostRays = 4096;

/// Makes keys of its own from those of BSDFs.
constexpr std::uint32_t kLent = 0x68e31da4u;

/// Places seen along the light, in units of the deviation from one of them.
struct View {
  View(const Double3& origin, const Vec3& along, double deviation)
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

/// The first surface along a ray that is more than a boundary of media; null where there is none.
const Surface* first_surface(const Scene& scene, Ray ray) {
  for (int i = 0; i < 16; ++i) {
    const auto point = scene.intersect(ray);
    if (!point) return nullptr;
    if (point->surface->lobes != kNullLobe) return point->surface;
    const float passed = length(point->p - ray.o);
    const Ray rest = Anchor::of(*point).leave(ray.d);
    ray = {rest.o, ray.d, ray.t_max - passed};
  }
  return nullptr;
}

/// A stretch of an edge with the part of G about y that falls on it.
struct Stretch {
  const MeshEdge* edge;
  double middle, low, high;  ///< middle: of G, along the edge; the others: error functions at its ends
  double shown, mass;        ///< shown: deviations seen per length
};

}  // namespace

double per_lit_face(const Scene& scene, const EdgePoint& x, const Vec3& d, double deviation,
                    KeyedRandom& random) {
  const auto depth = float(kDepth * deviation);
  // Rays that begin as near as that must not begin behind the face by rounding.
  if (!(depth > max_component(abs(x.p)) * gamma_bound(32))) return 0;
  if (first_surface(scene, {x.p, -d, depth})) return 0;
  Double3 s, t;
  make_basis(normalize(Double3(d)), s, t);
  for (int rays = 1; rays <= kMostRays; ++rays) {
    const double r2 = -2 * std::log1p(-double(random.next())), phi = 2 * pi * random.next();
    if (r2 > kReach * kReach) {
      --rays;
      continue;
    }
    const double r = deviation * std::sqrt(r2);
    const Vec3 o = (x.x + s * (r * std::cos(phi)) + t * (r * std::sin(phi))).to_float() - depth * d;
    const Surface* surface = first_surface(scene, {o, d, 2 * depth});
    if (surface && surface->lends) return rays;
  }
  return 0;
}

Spectrum diffracted_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d,
                       const SceneEdges::Beams& beams, KeyedRandom& random) {
  // Directions from the cones of all edges near by, and from a lobe about that of the light, where corners send it.
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
  const float choice = random.next();
  const float u[4] = {random.next(), random.next(), random.next(), random.next()};
  Vec3 out;
  if (choice < kLobe) {
    const double w = u[0] * 4 / (a2 + 4), v = a2 * w / (1 - w);  // the squared difference of the directions
    const double cosine = 1 - 0.5 * v, sine = std::sqrt(std::max(0.0, v * (1 - 0.25 * v))),
                 phi = 2 * pi * u[1];
    const Double3 z = normalize(Double3(d));
    Double3 s, t;
    make_basis(z, s, t);
    out = normalize((z * cosine + s * (sine * std::cos(phi)) + t * (sine * std::sin(phi))).to_float());
  } else {
    const double share = (choice - kLobe) / (1 - kLobe) * double(near.size());
    const auto direction =
        edges.scatter(on(near[std::min(std::size_t(share), near.size() - 1)]), d, beams, u);
    if (!direction) return 0.f;
    out = direction->d;
  }
  const Double3 turn = Double3(out) - Double3(d);
  const double v = dot(turn, turn);
  double pdf = kLobe * a2 / (pi * (a2 + v) * (a2 + v)) * (a2 + 4) / 4;
  for (const MeshEdge* edge : near)
    pdf += (1 - kLobe) / double(near.size()) * edges.scatter_pdf(on(edge), d, out, beams);
  const Vec2 drawn{random.next(), random.next()};
  return edges.kernel(x, d, out, beams, drawn) * float(1 / pdf);
}

bool lends_light(const Scene& scene, const Vec3& y) {
  constexpr double kFarthest = 5.84;
  static_assert(kFarthest * kFarthest >= kReach * kReach + kDepth * kDepth);
  return scene.edges()->are_within(float(kFarthest * kSpread) * scene.edges()->widest_beam(), y);
}

Spectrum left_by_edges(const Scene& scene, const Vec3& y, const Vec3& d, const Wavelengths& w,
                       std::uint32_t key) {
  const SceneEdges& edges = *scene.edges();
  const SceneEdges::Beams beams = edges.beams(w);
  const double deviation = kSpread * beams.widest;
  const auto radius = float(kReach * deviation), depth = float(kDepth * deviation);
  thread_local std::vector<Stretch> stretches;
  stretches.clear();
  double all = 0;
  const View view(Double3(y), d, deviation);
  edges.index().visit_edges({y, d, radius, -depth, depth}, [&](const MeshEdge& edge) {
    const EdgeLine line(edge);
    const Double3 from = view(line.origin), to = view(line.at(line.length)), way = to - from;
    const double shown2 = way.x * way.x + way.y * way.y;
    const double shown = std::sqrt(shown2) / line.length;
    if (!(shown * deviation > 1e-3)) return;
    // Of the fraction along it: between the depths, and the foot of y.
    double begin = 0, end = 1;
    if (std::abs(way.z) > 1e-12) {
      const double t0 = (-kDepth - from.z) / way.z, t1 = (kDepth - from.z) / way.z;
      begin = std::max(begin, std::min(t0, t1)), end = std::min(end, std::max(t0, t1));
    }
    if (!(begin < end)) return;
    const double foot = -(from.x * way.x + from.y * way.y) / shown2;
    const double off_x = from.x + foot * way.x, off_y = from.y + foot * way.y;
    if (off_x * off_x + off_y * off_y > kReach * kReach) return;
    const double low = std::erf((begin - foot) * std::sqrt(0.5 * shown2)),
                 high = std::erf((end - foot) * std::sqrt(0.5 * shown2));
    const double mass =
        std::exp(-0.5 * (off_x * off_x + off_y * off_y)) * 0.5 * (high - low) / (std::sqrt(2 * pi) * shown);
    if (!(mass > 0)) return;
    stretches.push_back({&edge, foot * line.length, low, high, shown, mass});
    all += mass;
  });
  if (!(all > 0)) return 1.f;
  KeyedRandom random(key ^ kLent);
  // Where little can be taken it is looked at seldom: S is about a quarter of sigma, N half.
  const double about = 0.5 * all / (deviation * deviation) * beams.widest;
  const double probability = std::clamp(4 * about, 0.01, 1.0);
  if (random.next() >= probability) return 1.f;
  double rest = random.next() * all;
  std::size_t i = 0;
  for (; i + 1 < stretches.size() && rest >= stretches[i].mass; ++i) rest -= stretches[i].mass;
  const Stretch& s = stretches[i];
  const EdgeLine line(*s.edge);
  const double z = sample_between(s.low, s.high, random.next());
  const double at = std::clamp(s.middle + z * std::numbers::sqrt2 / s.shown, 0.0, line.length);
  const EdgePoint x = edges.place_on(*s.edge, at / line.length);
  const double per_face = per_lit_face(scene, x, d, deviation, random);
  if (!(per_face > 0)) return 1.f;
  return Spectrum(1.f) - diffracted_at(edges, x, d, beams, random) *
                             float(all * per_face / (deviation * deviation * probability));
}

}  // namespace aureole
