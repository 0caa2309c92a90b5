// SPDX-License-Identifier: Apache-2.0
// Where light passes beside a place on an edge: what the edge diffracts is taken from there (transport/edge_ledger.h).
#pragma once

#include <optional>
#include <string>

#include "aureole/core/keyed_random.h"
#include "aureole/scene/edge/scene_edges.h"

namespace aureole {

struct SceneSurfaces;

namespace beside {

/// Standard deviation of G over the widest sigma: small, since the light that is missing comes from next to the edge, but not so small that
/// corners of openings lend more than they have (docs/decisions/0128-diffracted-from-open-side.md).
inline constexpr double kSpread = 0.6;
/// Beyond this distance across the light, in these deviations, G counts as 0 (4e-5 of it).
inline constexpr double kReach = 4.5;
/// Free way before and behind an edge that light needs to pass it, in sigma.
inline constexpr float kPassing = 3;

}  // namespace beside

/// An estimate of 1/N, a number of 1 and more, N the part of the Gaussian of that standard deviation about x that light along `d` passes, on
/// ways of that length before and behind it [unit of length of the scene]. Nothing where none passes x itself; 0 where it passes so little
/// of the Gaussian that thousands of rays have not met it.
std::optional<double> per_open_way(const SceneSurfaces& surfaces, const EdgePoint& x, const Vec3& d,
                                   double deviation, double depth, KeyedRandom& random);

/// A note where `per_open_way` is 0 at some of the edges; empty: at none.
std::string note_on_slits(const SceneSurfaces& surfaces, const SceneEdges& edges);

}  // namespace aureole
