// SPDX-License-Identifier: Apache-2.0
// The region beside a point of an edge through which light passes: the power that the edge diffracts is
// removed from the light there (transport/edge_ledger.h).
#pragma once

#include <optional>
#include <string>

#include "aureole/core/keyed_random.h"
#include "aureole/scene/edge/scene_edges.h"

namespace aureole {

struct SceneSurfaces;

namespace beside {

/// Standard deviation of the Gaussian G, over the widest sigma. It is small, since the removed light comes
/// from next to the edge, but not so small that more light would be removed at corners of openings than there
/// is (docs/decisions/0128-diffracted-from-open-side.md).
inline constexpr double kSpread = 0.6;
/// Distance across the light, in standard deviations of G, beyond which G counts as 0; 4e-5 of G lies there.
inline constexpr double kReach = 4.5;
/// Length of the unoccluded segment that light needs before and behind an edge to pass it, in sigma.
inline constexpr float kPassing = 3;

}  // namespace beside

/// Returns an unbiased estimate of 1/N, a number of at least 1. N is the part of the Gaussian of standard
/// deviation `deviation` about x through which light along `d` passes, on segments of length `depth` before
/// and behind it [unit of length of the scene]. Empty if no light passes at x itself; 0 if thousands of rays
/// have found no unoccluded segment.
std::optional<double> per_open_way(const SceneSurfaces& surfaces, const EdgePoint& x, const Vec3& d,
                                   double deviation, double depth, KeyedRandom& random);

/// Returns a note if `per_open_way` is 0 at some of the edges; else an empty text.
std::string note_on_slits(const SceneSurfaces& surfaces, const SceneEdges& edges);

}  // namespace aureole
