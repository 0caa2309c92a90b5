// SPDX-License-Identifier: Apache-2.0
// Assignment of a vertex's random numbers (docs/conventions.md, "Random numbers").
#pragma once

#include "aureole/sampler/sampler.h"

namespace aureole {

/// Pairs, for directions and places. At an emitter, vertex 0 of a path of light: the direction and the place
/// it starts from.
enum class Pair { scatter = 0, connection = 1 };
/// Single numbers, for choices. At an emitter `light` is the first of two numbers that choose its part.
enum class Choice { light = 0, lobe = 1, roulette = 2, distance = 3 };

inline float get(SampleStream& samples, int vertex, Choice which) {
  return samples.get1(SampleStream::choice(vertex, int(which)));
}
/// `pairs` are the numbers of SampleStream::directions, which looks up both pairs of a vertex.
inline Vec2 get(const float* pairs, Pair which) { return {pairs[2 * int(which)], pairs[2 * int(which) + 1]}; }
inline Vec2 get(SampleStream& samples, int vertex, Pair which) {
  return get(samples.directions(vertex), which);
}
/// Keys for decisions that need an unknown number of random numbers: of a stochastic BSDF, of a connection in
/// media, of a flight in one.
enum class Key { bsdf = 0, connection = 2, flight = 3 };
inline std::uint32_t key(const SampleStream& samples, int vertex, Key which = Key::bsdf) {
  return samples.key(SampleStream::choice(vertex, int(which)));
}

}  // namespace aureole
