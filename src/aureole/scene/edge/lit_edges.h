// SPDX-License-Identifier: Apache-2.0
// `LitEdges`: the irradiated fraction of each edge for each lamp. Nearly all edges of a city lie in the
// shadow of others, and light that an edge diffracts has to reach it: the sampling of edges (EdgeTree) is
// guided by rays that are traced to the lamps when the scene is built.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "aureole/emitter/light.h"
#include "aureole/scene/edge/scene_edges.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/ray_tracer.h"

namespace aureole {

/// Returns a representative end of light from a lamp to the point `seen_from`: the point on the lamp, or the
/// direction to it, that `u` samples. If the lamp does not irradiate that point, the result is the lamp's
/// centre, or empty for a lamp at infinity.
std::optional<PathEnd> lamp_end(const Light& light, std::size_t part, Vec2 u, const Vec3& seen_from,
                                const Wavelengths& w);
/// Returns two numbers in [0, 1) that choose the point of the lamp for visibility test number `look` of
/// `count`; all points differ.
Vec2 look_numbers(int look, int count);
/// Whether the segment between a point on an edge and an end of a path is unoccluded.
bool is_open(const RayTracer& tracer, const EdgePoint& from, const PathEnd& to);

class LitEdges {
public:
  LitEdges() = default;
  /// Traces rays to the strongest lamps, at most a few million in all. `w`: any wavelengths.
  LitEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
           const LightSampler& sampler, const Wavelengths& w);

  /// The data of one lamp. They change the noise of pictures and not their mean.
  struct Lamp {
    std::uint32_t light;
    std::size_t part;
    std::vector<std::uint32_t> edges;  ///< numbers of the edges that the lamp irradiates
    std::vector<float> lit;            ///< irradiated fraction of each node of the tree of edges, in (0, 1]
    float nearest = kInfinity;         ///< distance of the lamp from an irradiated edge
  };
  const std::vector<Lamp>& lamps() const { return lamps_; }
  /// Returns the data of a lamp, or null if there are none.
  const Lamp* from(const Light& light, std::size_t part) const {
    for (const Lamp& lamp : lamps_)
      if (lamp.light == light.index && lamp.part == part) return &lamp;
    return nullptr;
  }

private:
  std::vector<Lamp> lamps_;
};

}  // namespace aureole
