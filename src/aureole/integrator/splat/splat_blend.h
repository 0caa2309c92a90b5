// SPDX-License-Identifier: Apache-2.0
// The colour of projected splats at positions of the film.
#pragma once

#include <span>

#include "aureole/integrator/splat/projected_splats.h"

namespace aureole {

/// A position of the film, with the colour of the splats there.
struct SplatSample {
  Vec2 film;
  float limit = kInfinity;  ///< distance from the camera behind which nothing is seen

  float color[3] = {0, 0, 0};  ///< of all splats, weighted by opacity, in the colours that are blended
  float transmittance = 1;     ///< the part of the light from behind that passes
  float distance = kInfinity;  ///< of the splat that first leaves half of it or less; infinity: none
};

/// Upper bound of the number of samples of one call.
inline constexpr int kSplatLanes = 16;

/// Finds colour, transmittance and distance of at most kSplatLanes samples; the result of one does not depend on the others.
void blend_splats(const ProjectedSplats& splats, const SplatSettings& settings,
                  std::span<SplatSample> samples);

}  // namespace aureole
