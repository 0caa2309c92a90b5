// SPDX-License-Identifier: Apache-2.0
// `SeenEdges`: of the edges that a lamp shines on, those that places of a sensor see. Of the lit edges of a city each cell of a power map
// sees a few, which the tree of edges cannot know: light that goes around one edge from a lamp to the sensor chooses among them by tables
// that rays have filled when the scene was built.
#pragma once

#include <optional>
#include <vector>

#include "aureole/scene/edge/lit_edges.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

class SeenEdges {
public:
  /// Of one lamp and one stratum of the sensor's places.
  struct Table {
    /// More edges are left to the tree: a choice looks at all of a table.
    static constexpr std::size_t kMost = 64;
    std::vector<std::uint32_t> edges;  ///< their numbers, ascending
    bool is_known = true;              ///< else more are seen

    bool has(std::uint32_t edge) const;
    struct Choice {
      std::uint32_t edge;
      float probability;
    };
    /// Of a table that is not empty, in proportion to the estimate of the light of each (EdgeTree).
    Choice choose(const SceneEdges& scene_edges, const PathEnd& a, const PathEnd& b,
                  const SceneEdges::Beams& beams, float u) const;
  };

  SeenEdges() = default;
  /// For sensors with many places, such as maps. `w`: any wavelengths.
  SeenEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
            const LitEdges& lit, const PlacedSensor& sensor, const Wavelengths& w);

  /// For the places that `lens` chooses (Sensor::sample_direct). Null where nothing is known; else what is not in the table may be seen
  /// nevertheless: rays end at four of the places.
  const Table* from(const Light& light, std::size_t part, Vec2 lens) const;

  /// About the part of the film that edges fill, whatever hides them: what the sensor sees of them at once comes together on as many
  /// pixels.
  float film_part() const { return film_part_; }

private:
  float film_part_ = 1;
  struct Lamp {
    std::uint32_t light;
    std::size_t part;
    std::vector<Table> tables;
  };
  int strata_x_ = 1, strata_y_ = 1;  ///< of the two numbers of `lens`
  std::vector<Lamp> lamps_;
};

}  // namespace aureole
