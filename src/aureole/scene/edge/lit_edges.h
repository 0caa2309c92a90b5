// SPDX-License-Identifier: Apache-2.0
// `LitEdges`: how much of each edge a lamp shines on. Of the edges of a city nearly all lie in the shadow of others, and light that goes
// around an edge has to reach it: the choice of edges (EdgeTree) is guided by what rays to the lamps have found when the scene was built.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "aureole/emitter/light.h"
#include "aureole/scene/edge/scene_edges.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/ray_tracer.h"

namespace aureole {

/// About where a lamp is for light that goes to a place: a point of it, or a direction to it, that two numbers choose; its middle where
/// that place does not see it. Nothing for a lamp at infinity that it does not see.
std::optional<PathEnd> lamp_end(const Light& light, std::size_t part, Vec2 u, const Vec3& seen_from,
                                const Wavelengths& w);
/// Two numbers for the look of that number, of `count` looks at different points of a lamp.
Vec2 look_numbers(int look, int count);
/// Whether nothing is in the way between a place on an edge and an end of a path.
bool is_open(const RayTracer& tracer, const EdgePoint& from, const PathEnd& to);

class LitEdges {
public:
  LitEdges() = default;
  /// Of the strongest lamps, as many as a few million rays serve. `w`: any wavelengths.
  LitEdges(const SceneEdges& edges, const RayTracer& tracer, std::span<const Light> lights,
           const LightSampler& sampler, const Wavelengths& w);

  /// What is known of a lamp changes the noise of pictures and not their mean.
  struct Lamp {
    std::uint32_t light;
    std::size_t part;
    std::vector<std::uint32_t> edges;  ///< the numbers of those that it shines on
    std::vector<float> lit;            ///< how much of each node of the tree of edges, over 0 and at most 1
    float nearest = kInfinity;         ///< distance of the lamp from a lit place on an edge
  };
  const std::vector<Lamp>& lamps() const { return lamps_; }
  /// Null where nothing is known.
  const Lamp* from(const Light& light, std::size_t part) const {
    for (const Lamp& lamp : lamps_)
      if (lamp.light == light.index && lamp.part == part) return &lamp;
    return nullptr;
  }

private:
  std::vector<Lamp> lamps_;
};

}  // namespace aureole
