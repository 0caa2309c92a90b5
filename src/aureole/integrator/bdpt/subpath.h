// SPDX-License-Identifier: Apache-2.0
// Shared by the two kinds of subpaths of `bdpt`: which techniques count, and the state of a subpath.
//
// Edges that diffract light (transport/edges.h) are vertices that one of the two ends finds, which the path itself decides:
// seen from the sensor, an edge is looked for from the vertex before it, unless that is a mirror or smooth glass, which
// nothing can be connected with. That edge, and all those before it as the light goes, are found from the emitter. So of a path with
// edges those techniques are left that connect it between the last edge which the emitter finds and the first one which the sensor
// finds: their densities are summed as without edges, and those beyond are none. An edge that the sensor has found is
// connected with the vertices of paths of light, and the one next to a lamp is chosen for both of its neighbours, as in `path`.
#pragma once

#include <memory>
#include <vector>

#include "aureole/integrator/path_limits.h"
#include "aureole/transport/edges.h"
#include "aureole/transport/two_way.h"

namespace aureole::bdpt {

/// Which techniques count, by their numbers of vertices from the emitter and from the sensor; -1: any.
struct Techniques {
  int s, t;

  /// All, weighted. Those chosen otherwise count in full.
  bool are_weighted() const { return s < 0 && t < 0; }
  bool have(int from_emitter, int from_sensor) const {
    return (s < 0 || s == from_emitter) && (t < 0 || t == from_sensor);
  }
  /// Whether paths of light count that have a second vertex.
  bool need_light() const { return s != 0 && s != 1; }
  /// Other techniques' densities, as far as they count.
  Spectrum others(const Spectrum& densities) const { return are_weighted() ? densities : Spectrum(0.f); }
};

struct Settings {
  PathLimits limits;
  Techniques techniques;
};

/// A vertex of a path of light, kept for connections.
struct LightVertex {
  template <class... Args>
  explicit LightVertex(const Args&... args) : vertex(args...) {}

  Vertex vertex;
  LightSubpathDensity density;
  int edges = 0;                          ///< from the emitter
  int in_media = 0;                       ///< vertices in media so far, this one included
  const LightVertex* previous = nullptr;  ///< that may be connected
};

/// Room for the vertices of a batch, which are made in place.
class LightVertices {
public:
  template <class... Args>
  LightVertex& make(const Args&... args) {
    if (used_ % kChunk == 0 && used_ / kChunk == chunks_.size())
      chunks_.push_back(std::make_unique_for_overwrite<Room[]>(kChunk));
    Room& room = chunks_[used_ / kChunk][used_ % kChunk];
    ++used_;
    return *new (room.bytes) LightVertex(args...);
  }

private:
  static_assert(std::is_trivially_destructible_v<LightVertex>);
  static constexpr std::size_t kChunk = 64;
  struct Room {
    alignas(LightVertex) std::byte bytes[sizeof(LightVertex)];
  };
  std::vector<std::unique_ptr<Room[]>> chunks_;
  std::size_t used_ = 0;
};

/// A subpath up to its last vertex, and the ray that it goes on along.
template <PathStart kStart>
struct Subpath {
  Flight flight;
  TwoWayDensity<kStart> density;  ///< up to and including the direction of `flight`
  TwoWayDensity<kStart> arrived;  ///< at the present vertex
  Vec3 from;                      ///< the last vertex
  int scattered = 0;
  int in_media = 0;  ///< of these
  int vertex = 0;    ///< number of the present vertex for random numbers; surfaces that were passed count
  float whole = 1;   ///< throughput where the path begins: roulette asks how much of it is left
  AfterEdge after_edge;
};

// These make other keys of one, for ways to edges.
inline constexpr std::uint32_t kAroundEdges = 0x7feb352du, kToEdge = 0x2545f491u, kFromEnd = 0x846ca68bu;

/// Completes a connection whose `light` is f over the density of the path with the densities, relative to that, of
/// this and of other techniques.
inline void weigh(const Scene& scene, const Spectrum& own, const Spectrum& other, const Wavelengths& w,
                  Connection& out) {
  if (scene.has_media()) {
    out.own = own, out.other = other;
    out.light = out.light / w.pdf;
  } else {
    out.light = out.light / (w.pdf * sum(own + other));
  }
}

}  // namespace aureole::bdpt
