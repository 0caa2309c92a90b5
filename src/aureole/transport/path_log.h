// SPDX-License-Identifier: Apache-2.0
// The log of a replayed path: what happens to it, event by event. `--pixel` prints them as lines; tests
// compare them with a calculation that shares no code with it.
#pragma once

#include <functional>
#include <string>

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

struct Light;
class Medium;
struct SurfacePoint;

struct PathEvent {
  enum class Kind : std::uint8_t {
    start,       ///< a light path starts at a light or in a medium that emits, at `p` along `d`
    surface,     ///< a vertex on a surface at `p`, or a hit of a light
    medium,      ///< a vertex in a medium at `p`
    exit,        ///< the path was refracted into a surface with a BSSRDF and leaves it at `p`
    edge,        ///< the path turns around an edge that diffracts light, at `p`
    escape,      ///< the ray leaves the scene along `d`
    emission,    ///< emission found by hitting a light at `p`, or in the direction `d`
    connection,  ///< a connection with a light at `p` (infinite: along `d`) or with a vertex of a light path
    sensor,      ///< a connection with the sensor at `p`, at the film position `film`
    other,       ///< light of another kind, which `text` describes
  };

  Kind kind;
  int depth = 0;          ///< number of segments from the start of the path
  Vec3 p{};               ///< position in world space
  Vec3 d{};               ///< unit direction in world space
  bool infinite = false;  ///< the far end is at infinity along `d`
  float throughput = 0;   ///< throughput relative to the throughput at the start of the path
  int vertex = 0;    ///< for a connection with a light path: number of segments of that path up to its vertex
  bool open = true;  ///< a connection is not occluded
  bool along_ray = false;  ///< the connection begins at a sampled position along the ray, which is no vertex
  Vec3 from{};             ///< where a connection begins, in world space
  /// Contribution to the estimate, as RadianceEstimate::estimate; 0 where there is none.
  Spectrum estimate{0.f};
  Vec2 film{};                          ///< pixels from the film's top left corner
  const SurfacePoint* point = nullptr;  ///< the point of an event `surface` or `exit`; valid during the call
  const Light* light = nullptr;         ///< the light of an event `start`
  std::size_t part = 0;                 ///< the sampled part of `light`
  const Medium* in_medium = nullptr;    ///< the medium of an event `start` or `medium`
  const char* text = "";
};

/// Receives the events of a path. Empty in normal rendering.
using PathLog = std::function<void(const PathEvent&)>;

/// The event as a line of text.
std::string to_string(const PathEvent& event);

/// The log of a batch: it receives the events of one path of the batch, or of none.
class BatchLog {
public:
  BatchLog() = default;
  BatchLog(const PathLog& log, int path) : log_(log ? &log : nullptr), path_(path) {}
  bool follows(int path) const { return log_ != nullptr && path == path_; }
  void operator()(const PathEvent& event) const { (*log_)(event); }

private:
  const PathLog* log_ = nullptr;
  int path_ = -1;
};

}  // namespace aureole
