// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/seen_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/core/random.h"

namespace aureole {
namespace {

/// Largest number of edges that are tested for each stratum: those with the largest estimates of their light.
constexpr std::size_t kMostTried = 256;
constexpr int kMostStrata = 64;  ///< along an axis
/// Largest number of estimates of the light of an edge, for all tables.
constexpr double kMostEstimates = 1e8;
constexpr double kMostTables = 4096;  ///< of all lamps, since each table may trace some thousand rays
constexpr int kPlaces = 4;            ///< sensor points of a stratum
/// Fraction of choices that takes all edges of a table with equal probability.
constexpr double kEvenly = 0.1;

using Table = SeenEdges::Table;

/// The data from which all tables of a lamp are filled.
struct Filler {
  const SceneEdges& edges;
  const RayTracer& tracer;
  const Light& light;
  const LitEdges::Lamp& lit;
  const PlacedSensor& sensor;
  const Wavelengths& w;
  SceneEdges::Beams beams;
  Vec3 middle;  ///< of the scene

  /// Whether light from the lamp by way of an edge to the sensor is unoccluded.
  bool is_lit(const MeshEdge& edge, const PathEnd& eye, const PathEnd& lamp, Vec2 lens) const {
    const EdgeLine line(edge);
    const double at = std::clamp(keller_point(line, eye, lamp).value_or(0.5 * line.length), 0.0, line.length);
    const EdgePoint point = edges.place_on(edge, at / line.length);
    const auto seen = sensor.sample_direct(point.on_edge(), lens);
    return seen && seen->importance > 0 && is_open(tracer, point, PathEnd{seen->p}) &&
           is_open(tracer, point, lamp);
  }

  Table fill(Vec2 lower, Vec2 size) const {
    std::array<Vec2, kPlaces> lenses;
    std::array<PathEnd, kPlaces> eyes, lamps;
    Table table;
    for (int i = 0; i < kPlaces; ++i) {
      const auto k = std::size_t(i);
      lenses[k] = {lower.x + size.x * (i % 2 ? 0.75f : 0.25f), lower.y + size.y * (i / 2 ? 0.75f : 0.25f)};
      const auto seen = sensor.sample_direct(middle, lenses[k]);
      const auto lamp = seen ? lamp_end(light, lit.part, look_numbers(i, kPlaces), seen->p, w) : std::nullopt;
      if (!lamp) {  // the sensor point is unknown, and so is the stratum
        table.is_known = false;
        return table;
      }
      eyes[k] = PathEnd{seen->p}, lamps[k] = *lamp;
    }
    std::vector<std::pair<double, std::uint32_t>> tried;
    for (const std::uint32_t edge : lit.edges)
      if (const double estimate =
              EdgeTree::estimate(edges.index().edges()[edge], eyes[0], lamps[0], beams.angle, beams.widest);
          estimate > 0)
        tried.push_back({-estimate, edge});
    if (tried.size() > kMostTried) {
      std::nth_element(tried.begin(), tried.begin() + kMostTried, tried.end());
      tried.resize(kMostTried);
    }
    std::ranges::sort(tried, {}, [](const auto& t) { return t.second; });
    for (const auto& [estimate, edge] : tried) {
      const MeshEdge& tried_edge = edges.index().edges()[edge];
      for (std::size_t k = 0; k < kPlaces; ++k)
        if (is_lit(tried_edge, eyes[k], lamps[k], lenses[k])) {
          table.edges.push_back(edge);
          break;
        }
    }
    if (table.edges.size() > Table::kMost) table.is_known = false, table.edges.clear();
    return table;
  }
};

/// Computes `SeenEdges::film_part`.
float part_of_film(const SceneEdges& edges, const Vec3& middle, const PlacedSensor& sensor) {
  constexpr int kMostCells = 64, kPlaces = 4096;
  const Vec2 size = sensor.part.upper - sensor.part.lower;
  const auto cells_along = [&](float pixels) { return std::clamp(int(pixels), 1, kMostCells); };
  const int columns = cells_along(size.x), rows = cells_along(size.y);
  std::vector<std::uint32_t> counts(std::size_t(columns * rows));
  double all = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const auto random = [&](std::uint64_t j) {
      return unit_float(std::uint32_t(combine_bits(std::uint64_t(i), j) >> 32));
    };
    const Vec2 lens{random(0), random(1)};
    const auto eye = sensor.sample_direct(middle, lens);
    const float u[3] = {random(2), random(3), random(4)};
    const auto place = edges.choose_from({eye ? eye->p : middle}, u);
    const auto seen = place ? sensor.sample_direct(place->on_edge(), lens) : std::nullopt;
    if (!seen || !(seen->importance > 0)) continue;
    const auto cell = [](float at, float least, float extent, int cells) {
      return std::clamp(int((at - least) / extent * float(cells)), 0, cells - 1);
    };
    ++counts[std::size_t(cell(seen->film.y, sensor.part.lower.y, size.y, rows) * columns +
                         cell(seen->film.x, sensor.part.lower.x, size.x, columns))];
    ++all;
  }
  // One over the probability that two points are in one cell.
  double pairs = 0;
  for (const double count : counts) pairs += count * (count - 1);
  return all < 2 ? 1.f : float(std::min(1.0, all * (all - 1) / (std::max(pairs, 1.0) * columns * rows)));
}

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
  // Corners diffract a little in directions that Keller's condition, which the estimate follows, excludes.
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
  const Vec3 middle = tracer.bounds().center();
  if (!edges.empty()) film_part_ = part_of_film(edges, middle, sensor);
  std::vector<const LitEdges::Lamp*> worth;
  double all = 0;
  for (const LitEdges::Lamp& lamp : lit.lamps())
    // Lamps at infinity, such as the sky, are left out: a few directions do not represent them.
    if (!lamp.edges.empty() && !lights[lamp.light].is_infinite())
      worth.push_back(&lamp), all += double(lamp.edges.size());
  if (worth.empty()) return;
  Bounds3 places;
  for (const Vec2 lens :
       {Vec2{0.5f, 0.5f}, Vec2{0.01f, 0.01f}, Vec2{0.99f, 0.01f}, Vec2{0.01f, 0.99f}, Vec2{0.99f, 0.99f}})
    if (const auto seen = sensor.sample_direct(middle, lens)) places.extend(seen->p);
  // Sensors with one position are left out: a camera sees more edges than a table holds.
  if (places.empty() || !(length(places.diagonal()) > 1e-3f * length(tracer.bounds().diagonal()))) return;
  // Filling the tables of a map must not take longer than a picture with a few samples.
  constexpr float kPixels = 4;
  const Vec2 pixels = sensor.part.upper - sensor.part.lower;
  const auto most = [](float along) { return std::clamp(double(along) / kPixels, 1.0, double(kMostStrata)); };
  const double tables = std::min(kMostEstimates / all, kMostTables / double(worth.size())),
               fewer = std::min(1.0, std::sqrt(tables / (most(pixels.x) * most(pixels.y))));
  strata_x_ = std::max(1, int(most(pixels.x) * fewer)), strata_y_ = std::max(1, int(most(pixels.y) * fewer));
  for (const LitEdges::Lamp* lamp : worth) {
    const Filler filler{edges, tracer, lights[lamp->light], *lamp, sensor, w, edges.beams(w), middle};
    Lamp& own = lamps_.emplace_back(Lamp{lamp->light, lamp->part, {}});
    own.tables.resize(std::size_t(strata_x_) * std::size_t(strata_y_));
    const Vec2 size{1 / float(strata_x_), 1 / float(strata_y_)};
    for_ranges(
        own.tables.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            own.tables[i] = filler.fill(
                {size.x * float(i % std::size_t(strata_x_)), size.y * float(i / std::size_t(strata_x_))},
                size);
        },
        16);
  }
}

const Table* SeenEdges::from(const Light& light, std::size_t part, Vec2 lens) const {
  for (const Lamp& lamp : lamps_)
    if (lamp.light == light.index && lamp.part == part) {
      const auto stratum = [](float u, int strata) {
        return std::size_t(std::clamp(int(u * float(strata)), 0, strata - 1));
      };
      const Table& table =
          lamp.tables[stratum(lens.y, strata_y_) * std::size_t(strata_x_) + stratum(lens.x, strata_x_)];
      return table.is_known ? &table : nullptr;
    }
  return nullptr;
}

}  // namespace aureole
