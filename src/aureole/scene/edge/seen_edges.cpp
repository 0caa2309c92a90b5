// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/seen_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

/// With fewer lit edges the tree of edges serves.
constexpr std::size_t kFewest = 64;
/// Of each stratum as many edges are tried, those that send most light if nothing is in the way.
constexpr std::size_t kMostTried = 256;
constexpr int kMostStrata = 64;  ///< along an axis
/// Estimates of the light of an edge, for all tables.
constexpr double kMostEstimates = 1e8;
constexpr int kPlaces = 4;  ///< of a stratum
/// The part of choices that takes all edges of a table alike.
constexpr double kEvenly = 0.1;

using Table = SeenEdges::Table;

/// What all tables of a lamp are made of.
struct Filler {
  const SceneEdges& edges;
  const RayTracer& tracer;
  const Light& light;
  const LitEdges::Lamp& lit;
  const PlacedSensor& sensor;
  const Wavelengths& w;
  SceneEdges::Beams beams;
  Vec3 middle;  ///< of the scene

  /// The lamp as seen from a place, of which one point stands for all.
  std::optional<PathEnd> lamp_from(const Vec3& p) const {
    const auto seen = light.sample_direct(p, lit.part, {0.5f, 0.5f}, w);
    if (!seen || !(seen->pdf > 0)) return {};
    return seen->infinite ? PathEnd{seen->wo, true} : PathEnd{seen->p};
  }

  bool is_open(const EdgePoint& from, const PathEnd& to) const {
    Ray ray{from.p, to.p, kInfinity};
    if (!to.is_infinite) ray.d = to.p - from.p, ray.t_max = 1 - 1e-4f;
    return !tracer.occluded(ray);
  }

  /// Whether nothing is in the way of light around an edge.
  bool is_lit(const MeshEdge& edge, const PathEnd& eye, const PathEnd& lamp, Vec2 lens) const {
    const EdgeLine line(edge);
    const double at = std::clamp(keller_point(line, eye, lamp).value_or(0.5 * line.length), 0.0, line.length);
    const EdgePoint point = edges.place_on(edge, at / line.length);
    const auto seen = sensor.sample_direct(point.on_edge(), lens);
    return seen && seen->importance > 0 && is_open(point, PathEnd{seen->p}) && is_open(point, lamp);
  }

  Table fill(Vec2 lower, float size) const {
    std::array<Vec2, kPlaces> lenses;
    std::array<std::optional<PathEnd>, kPlaces> eyes, lamps;
    for (int i = 0; i < kPlaces; ++i) {
      const auto k = std::size_t(i);
      lenses[k] = {lower.x + size * (i % 2 ? 0.75f : 0.25f), lower.y + size * (i / 2 ? 0.75f : 0.25f)};
      const auto seen = sensor.sample_direct(middle, lenses[k]);
      if (!seen) continue;
      eyes[k] = PathEnd{seen->p}, lamps[k] = lamp_from(seen->p);
    }
    const auto all = [&](std::size_t k, std::uint32_t edge) {
      return EdgeTree::estimate(edges.index().edges()[edge], *eyes[k], *lamps[k], beams.angle, beams.widest);
    };
    std::vector<std::pair<double, std::uint32_t>> tried;
    if (const auto k = std::size_t(std::ranges::find_if(lamps, [](const auto& l) { return l.has_value(); }) -
                                   lamps.begin());
        k < kPlaces)
      for (const std::uint32_t edge : lit.edges)
        if (const double estimate = all(k, edge); estimate > 0) tried.push_back({-estimate, edge});
    if (tried.size() > kMostTried) {
      std::nth_element(tried.begin(), tried.begin() + kMostTried, tried.end());
      tried.resize(kMostTried);
    }
    std::ranges::sort(tried, {}, [](const auto& t) { return t.second; });
    Table table;
    for (const auto& [estimate, edge] : tried) {
      const MeshEdge& tried_edge = edges.index().edges()[edge];
      for (std::size_t k = 0; k < kPlaces; ++k)
        if (lamps[k] && is_lit(tried_edge, *eyes[k], *lamps[k], lenses[k])) {
          table.edges.push_back(edge);
          break;
        }
    }
    if (table.edges.size() > Table::kMost) table.is_known = false, table.edges.clear();
    return table;
  }
};

}  // namespace

bool Table::has(std::uint32_t edge) const { return std::ranges::binary_search(edges, edge); }

Table::Choice Table::choose(const SceneEdges& scene_edges, const PathEnd& a, const PathEnd& b,
                            const SceneEdges::Beams& beams, float u) const {
  std::array<double, kMost> estimates;
  const std::size_t count = edges.size();
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += estimates[i] =
        EdgeTree::estimate(scene_edges.index().edges()[edges[i]], a, b, beams.angle, beams.widest);
  // Corners send a little where Keller's condition, which the estimate follows, says nothing.
  const double scale = sum > 0 && std::isfinite(sum) ? (1 - kEvenly) / sum : 0,
               evenly = (scale > 0 ? kEvenly : 1) / double(count);
  double rest = u;
  std::size_t i = 0;
  double probability;
  for (;; ++i) {
    probability = evenly + (scale > 0 ? scale * estimates[i] : 0);
    if (rest < probability || i + 1 == count) break;
    rest -= probability;
  }
  return {edges[i], float(probability)};
}

SeenEdges::SeenEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
                     const LitEdges& lit, const PlacedSensor& sensor, const Wavelengths& w) {
  std::vector<const LitEdges::Lamp*> worth;
  double all = 0;
  for (const LitEdges::Lamp& lamp : lit.lamps())
    if (lamp.edges.size() >= kFewest) worth.push_back(&lamp), all += double(lamp.edges.size());
  const Vec3 middle = tracer.bounds().center();
  const auto first = sensor.sample_direct(middle, {0.01f, 0.01f}),
             last = sensor.sample_direct(middle, {0.99f, 0.99f});
  if (worth.empty() || !first || !last) return;
  // The places of a lens are one for edges far away. Tables of a map shall not take longer than a picture of a few samples.
  constexpr float kPixels = 4;
  if (length(first->p - last->p) > 1e-3f * length(tracer.bounds().diagonal())) {
    const Vec2 pixels = sensor.part.upper - sensor.part.lower;
    const double most = std::min({double(kMostStrata), double(std::max(pixels.x, pixels.y)) / kPixels,
                                  std::sqrt(kMostEstimates / all)});
    strata_ = std::max(1, int(most / std::sqrt(double(worth.size()))));
  }
  const float size = 1 / float(strata_);
  for (const LitEdges::Lamp* lamp : worth) {
    const Filler filler{edges, tracer, lights[lamp->light], *lamp, sensor, w, edges.beams(w), middle};
    Lamp& own = lamps_.emplace_back(Lamp{lamp->light, lamp->part, {}});
    own.tables.resize(std::size_t(strata_) * std::size_t(strata_));
    for_ranges(
        own.tables.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            own.tables[i] = filler.fill(
                {size * float(i % std::size_t(strata_)), size * float(i / std::size_t(strata_))}, size);
        },
        16);
  }
}

const Table* SeenEdges::from(const Light& light, std::size_t part, Vec2 lens) const {
  for (const Lamp& lamp : lamps_)
    if (lamp.light == light.index && lamp.part == part) {
      const auto stratum = [&](float u) {
        return std::size_t(std::clamp(int(u * float(strata_)), 0, strata_ - 1));
      };
      const Table& table = lamp.tables[stratum(lens.y) * std::size_t(strata_) + stratum(lens.x)];
      return table.is_known ? &table : nullptr;
    }
  return nullptr;
}

}  // namespace aureole
