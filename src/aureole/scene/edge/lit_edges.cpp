// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/lit_edges.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

constexpr std::size_t kMostLamps = 16;
constexpr double kMostRays = 8e6;
constexpr int kMostPlaces = 4;  ///< along an edge
/// Irradiated fraction of an edge from which no ray has reached the lamp: light may reach the edge between
/// the rays.
constexpr float kLeast = 0.03f;

PathEnd end_of(const DirectSample& seen) { return seen.infinite ? PathEnd{seen.wo, true} : PathEnd{seen.p}; }

/// The irradiation of an edge by a lamp.
struct Lit {
  float part = kLeast;        ///< fraction of points from which a ray reaches the lamp
  float nearest = kInfinity;  ///< smallest distance of the edge from points of the lamp
};

/// Estimates the irradiated fraction of an edge; each point on the edge tests another point of the lamp.
Lit lit_part(const SceneEdges& edges, const RayTracer& tracer, const MeshEdge& edge, int places,
             const Light& light, std::size_t part, const Wavelengths& w) {
  Lit result;
  int lit = 0;
  for (int i = 0; i < places; ++i) {
    const EdgePoint point = edges.place_on(edge, (i + 0.5) / places);
    const auto seen = light.sample_direct(point.on_edge(), part, look_numbers(i, places), w);
    if (!seen || !(seen->pdf > 0)) continue;
    if (!is_open(tracer, point, end_of(*seen))) continue;
    ++lit;
    if (!seen->infinite) result.nearest = std::min(result.nearest, std::sqrt(edge.squared_distance(seen->p)));
  }
  result.part = std::max(kLeast, float(lit) / float(places));
  return result;
}

}  // namespace

std::optional<PathEnd> lamp_end(const Light& light, std::size_t part, Vec2 u, const Vec3& seen_from,
                                const Wavelengths& w) {
  if (const auto seen = light.sample_direct(seen_from, part, u, w); seen && seen->pdf > 0)
    return end_of(*seen);
  if (light.is_infinite()) return {};
  return PathEnd{light.emission_bounds(part).box.center()};
}

Vec2 look_numbers(int look, int count) {
  return {(float(look) + 0.5f) / float(count), std::fmod(0.5f + 0.618034f * float(look), 1.f)};
}

bool is_open(const RayTracer& tracer, const EdgePoint& from, const PathEnd& to) {
  Ray ray{from.p, to.p, kInfinity};
  if (!to.is_infinite) ray.d = to.p - from.p, ray.t_max = 1 - 1e-4f;
  return !tracer.occluded(ray);
}

LitEdges::LitEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
                   const LightSampler& sampler, const Wavelengths& w) {
  const std::vector<MeshEdge>& all = edges.index().edges();
  if (all.empty() || double(all.size()) > kMostRays) return;
  const int places = std::clamp(int(kMostRays / double(all.size())), 1, kMostPlaces);
  const double rays = double(places) * double(all.size());
  std::vector<std::pair<float, Lamp>> found;
  for (const Light& light : lights)
    for (std::size_t part = 0; part < light.part_count(); ++part)
      if (const float share = sampler.probability_by_power(light, part); share > 0)
        found.push_back({share, {light.index, part, {}, {}, kInfinity}});
  const std::size_t count =
      std::min({found.size(), kMostLamps, std::size_t(std::max(1.0, kMostRays / rays))});
  std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(count), found.end(),
                    [](const auto& a, const auto& b) {
                      return std::tuple(-a.first, a.second.light, a.second.part) <
                             std::tuple(-b.first, b.second.light, b.second.part);
                    });
  std::vector<float> lit(all.size()), nearest(all.size());
  for (std::size_t i = 0; i < count; ++i) {
    Lamp& lamp = found[i].second;
    const Light& light = lights[lamp.light];
    for_ranges(
        all.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t e = begin; e < end; ++e) {
            const Lit of_edge = lit_part(edges, tracer, all[e], places, light, lamp.part, w);
            lit[e] = of_edge.part, nearest[e] = of_edge.nearest;
          }
        },
        256);
    lamp.lit = edges.tree().of_nodes(lit);
    for (std::size_t e = 0; e < lit.size(); ++e)
      if (lit[e] > kLeast) lamp.edges.push_back(std::uint32_t(e));
    lamp.nearest = *std::ranges::min_element(nearest);
    lamps_.push_back(std::move(lamp));
  }
}

}  // namespace aureole
