// SPDX-License-Identifier: Apache-2.0
// Assignment of a vertex's random numbers (docs/conventions.md, "Random numbers").
#pragma once

#include "aureole/sampler/sampler.h"

namespace aureole {

/// Pairs of random numbers, for directions and positions. At an emitter (vertex 0 of a light path) they
/// sample the direction and the position that the path starts from.
enum class Pair { scatter = 0, connection = 1 };
/// Single random numbers, for discrete choices. At an emitter `light` is the first of two numbers that choose
/// its part.
enum class Choice { light = 0, lobe = 1, roulette = 2, distance = 3 };

inline float get(SampleStream& samples, int vertex, Choice which) {
  return samples.get1(SampleStream::choice(vertex, int(which)));
}
/// Returns one pair of a vertex. `pairs` are the numbers of SampleStream::directions, which returns both
/// pairs at once.
inline Vec2 get(const float* pairs, Pair which) { return {pairs[2 * int(which)], pairs[2 * int(which) + 1]}; }
inline Vec2 get(SampleStream& samples, int vertex, Pair which) {
  return get(samples.directions(vertex), which);
}
/// Version of the assignment of random numbers: pictures of another version have other noise, and their
/// states are not resumed or merged (render/state.h).
inline constexpr int kRandomVersion = 3;

/// Keyed streams, for decisions that need an unknown number of random numbers. Each belongs to a vertex.
enum class Stream {
  bsdf = 0,     ///< random numbers of a stochastic BSDF, and of the exit of a BSSRDF
  connection,   ///< transmittance of media along a connection; its diffraction factor
  distance,     ///< distance sampling behind the vertex; transmittance and diffraction factor of that segment
  emission,     ///< a connection with a medium that emits
  equiangular,  ///< a position along the segment behind the vertex, sampled about a light
  equiangular_connection,  ///< the connection of that position
  line_of_sight,           ///< a line of sight from the vertex
  receiver,                ///< a light that no ray hits, as a receiver sees it
  emitting_medium,         ///< where a light path starts in a medium
  diffracted_connection,   ///< a connection around an edge
  diffracted_walk,         ///< whether the path leaves the vertex for an edge, and how
  diffracted_start,        ///< a path that starts at an edge
  diffracted_light,        ///< light that reaches the sensor around one edge
  volume_march,            ///< a ray that `dvr` follows through a volume
};
/// Returns the key of a stream of a vertex.
inline std::uint32_t key(const SampleStream& samples, int vertex, Stream which) {
  constexpr int kStride = 1 << 24;  // upper bound of the number of dimensions of a vertex
  return samples.key(int(which) * kStride + SampleStream::choice(vertex, 0));
}

}  // namespace aureole
