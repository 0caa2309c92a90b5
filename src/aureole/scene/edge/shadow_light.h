// SPDX-License-Identifier: Apache-2.0
// How much light there is in a scene's shadows without edges: beside it what edges send there is looked at more or less often.
#pragma once

#include "aureole/scene/edge/scene_diffraction.h"

namespace aureole {

/// Light that comes to shadows by way of one surface, over what a lamp that shines there as it does on edges would send straight, over the
/// probability of that lamp by its power: of the places that the sensor sees those in shadow are taken as matt, and the lower quartile of
/// their ratios is the result. 0 where that is not known: where few of the places lie in shadow, and in scenes with media or with surfaces
/// that let pass. `w`: any wavelengths.
float light_in_shadows(const DiffractionInput& scene, const SceneEdges& edges, const LitEdges& lit_edges,
                       const Wavelengths& w);

}  // namespace aureole
