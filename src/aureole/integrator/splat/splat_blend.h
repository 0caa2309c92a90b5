// SPDX-License-Identifier: Apache-2.0
// The colour of projected splats at positions of the film.
#pragma once

#include <span>

#include "aureole/integrator/splat/projected_splats.h"

namespace aureole {

/// A position of the film, with the colour of the splats there.
struct SplatSample {
  Vec2 film;
  float limit = kInfinity;  ///< distance from the camera behind which splats are hidden

  float color[3] = {
      0, 0, 0};  ///< sum of the colours of all splats, weighted by opacity, in the colour space of blending
  float transmittance = 1;  ///< transmittance for the light from behind
  /// distance of the first splat behind which half of the light or less is left; infinity: none
  float distance = kInfinity;
};

/// Upper bound of the number of samples of one call.
inline constexpr int kSplatLanes = 16;

/// Computes colour, transmittance and distance of at most kSplatLanes samples. The result of a sample does
/// not depend on the others.
void blend_splats(const ProjectedSplats& splats, const SplatSettings& settings,
                  std::span<SplatSample> samples);

}  // namespace aureole
