// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/open_ways.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/scene/scene_surfaces.h"

namespace aureole {
namespace {

using std::numbers::pi;

/// Largest number of rays that search for an unoccluded segment beside an edge. The estimate is truncated in
/// slits that need more.
constexpr int kMostSlitRays = 4096;

/// Whether a surface other than a null surface is in the way of a ray.
bool is_in_the_way(const SceneSurfaces& surfaces, Ray ray) {
  if (surfaces.has_binary_visibility()) return surfaces.tracer->occluded(ray);
  for (int i = 0; i < 16; ++i) {
    const auto point = surfaces.intersect(ray);
    if (!point) return false;
    if (!point->surface->is_null()) return true;
    const float passed = length(point->p - ray.o);
    ray = {offset_origin(*point, ray.d), ray.d, ray.t_max - passed};
  }
  return true;
}

}  // namespace

std::optional<double> per_open_way(const SceneSurfaces& surfaces, const EdgePoint& x, const Vec3& d,
                                   double deviation, double depth, KeyedRandom& random) {
  const auto reach = float(depth);
  // A segment this short could begin behind the face, by rounding.
  if (!(reach > max_component(abs(x.p)) * gamma_bound(8))) return {};
  if (is_in_the_way(surfaces, {x.p, -d, reach}) || is_in_the_way(surfaces, {x.p, d, reach})) return {};
  Double3 s, t;
  make_basis(normalize(Double3(d)), s, t);
  for (int rays = 1; rays <= kMostSlitRays; ++rays) {
    const double r2 = -2 * std::log1p(-double(random.next())), phi = 2 * pi * random.next();
    if (r2 > beside::kReach * beside::kReach) {
      --rays;
      continue;
    }
    const double r = deviation * std::sqrt(r2);
    const Vec3 o = (x.x + s * (r * std::cos(phi)) + t * (r * std::sin(phi))).to_float() - reach * d;
    if (!is_in_the_way(surfaces, {o, d, 2 * reach})) return rays;
  }
  return 0;
}

std::string note_on_slits(const SceneSurfaces& surfaces, const SceneEdges& edges) {
  constexpr std::size_t kPlaces = 64;
  const std::vector<MeshEdge>& all = edges.index().edges();
  const std::size_t places = std::min(kPlaces, all.size());
  const double deviation = beside::kSpread * edges.widest_beam(),
               depth = double(beside::kPassing) * edges.widest_beam();
  std::size_t narrow = 0;
  for (std::size_t i = 0; i < places; ++i) {
    const MeshEdge& edge = all[i * all.size() / places];
    KeyedRandom random{std::uint32_t(i)};
    narrow +=
        per_open_way(surfaces, edges.place_on(edge, 0.5), edge.across(), deviation, depth, random) == 0.0;
  }
  if (narrow == 0) return {};
  return "edges: beside " + std::to_string(narrow) + " of " + std::to_string(places) +
         " of them that were tried light passes through so narrow a slit that less of it is missing there than "
         "they diffract; a smaller beam_width is more exact";
}

}  // namespace aureole
