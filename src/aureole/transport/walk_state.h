// SPDX-License-Identifier: Apache-2.0
// `WalkState`: the state of one path of a walk (transport/walk.h).
#pragma once

#include <span>

#include "aureole/transport/batch.h"
#include "aureole/transport/diffraction.h"
#include "aureole/transport/medium_segment.h"
#include "aureole/transport/path.h"
#include "aureole/transport/path_limits.h"
#include "aureole/transport/path_log.h"
#include "aureole/transport/segment_diffraction.h"

namespace aureole {

/// The batch that a walk follows.
struct WalkInput {
  const Scene& scene;
  const PathLimits& limits;
  std::span<Path> paths;
  const BatchLog& log;
  Arena& arena;  ///< where the walk allocates its records
};

/// State that only paths in `Space::any` have.
struct WalkStateInSpace {
  int in_media = 0;  ///< scattering events in media
  /// Emission along the present ray, including behind null surfaces, has already been counted.
  bool emission_counted = false;
  /// the first connection of the vertex, with a light or the sensor, was not occluded
  bool is_connected = false;
  /// throughput at the start of the path: Russian roulette uses throughput relative to it
  float first_throughput = 1;
};
struct WalkStateInEmptySpace {};

/// State of diffraction of a path in `Space::any`, which lies apart from what every step uses.
struct WalkDiffraction : DiffractionState {
  PendingSegments pending;
  SegmentChain chain;
};

template <Space kSpace, class Density>
struct WalkState : std::conditional_t<kSpace == Space::any, WalkStateInSpace, WalkStateInEmptySpace> {
  Segment segment;  ///< segment of the present ray
  Density density;  ///< throughput and pdfs up to and including the direction of the present ray
  /// the vertex that the present ray has left, from which connections may have sampled the light that the ray
  /// hits
  LightReference from;
  int depth = 0;    ///< scattering events so far
  int crossed = 0;  ///< crossings of surfaces that count for the limit of segments
  /// number of the present vertex as counted for random numbers, which includes crossed surfaces
  int vertex = 0;
  const float* pairs = nullptr;  ///< random numbers of the present vertex
  float eta2 = 1;  ///< squared index of refraction of the present medium over the sensor's: undoes the n^2 of
                   ///< radiance for Russian roulette; 1 in light paths
  /// paths from the sensor: the present surface may only be crossed; light paths: the limit ends the path
  /// after this vertex
  bool last = false;
};

}  // namespace aureole
