// SPDX-License-Identifier: Apache-2.0
// `SeenEdges`: for parts of a sensor, the edges that are both irradiated by a lamp and visible. Each cell of
// a power map of a city sees a few of the irradiated edges, which the tree of edges does not know. An edge
// that diffracts light from a lamp directly to the sensor is sampled from tables that rays fill when the
// scene is built.
#pragma once

#include <optional>
#include <vector>

#include "aureole/scene/edge/lit_edges.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

class SeenEdges {
public:
  /// The edges for one lamp and one stratum of the sensor's points.
  struct Table {
    /// Capacity of a table. If more edges are visible they are left to the tree, since a choice evaluates all
    /// edges of a table.
    static constexpr std::size_t kMost = 64;
    std::vector<std::uint32_t> edges;  ///< numbers of the edges, ascending
    bool is_known = true;              ///< false if more edges are visible

    bool has(std::uint32_t edge) const;
    struct Choice {
      std::uint32_t edge;
      float probability;
    };
    /// Samples an edge of a table, which must not be empty, in proportion to the estimate of the light of
    /// each edge (EdgeTree).
    Choice choose(const SceneEdges& scene_edges, const PathEnd& a, const PathEnd& b,
                  const SceneEdges::Beams& beams, float u) const;
  };

  SeenEdges() = default;
  /// Fills tables for sensors with many points, such as maps. `w`: any wavelengths.
  SeenEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
            const LitEdges& lit, const PlacedSensor& sensor, const Wavelengths& w);

  /// Returns the table for the sensor points that `lens` chooses (Sensor::sample_direct), or null if nothing
  /// is known. An edge that is not in the table may be visible nevertheless, since visibility is tested at
  /// four points of a stratum.
  const Table* from(const Light& light, std::size_t part, Vec2 lens) const;

  /// Returns an estimate of the fraction of the film that edges cover, regardless of occluders: diffracted
  /// light that reaches the sensor directly is concentrated on that fraction of the pixels.
  float film_part() const { return film_part_; }

private:
  float film_part_ = 1;
  struct Lamp {
    std::uint32_t light;
    std::size_t part;
    std::vector<Table> tables;
  };
  int strata_x_ = 1, strata_y_ = 1;  ///< strata of the two numbers of `lens`
  std::vector<Lamp> lamps_;
};

}  // namespace aureole
