// SPDX-License-Identifier: Apache-2.0
// The light in a scene's shadows without diffraction, which decides with what probability edges are sampled
// there.
#pragma once

#include "aureole/scene/edge/scene_diffraction.h"

namespace aureole {

/// Returns an estimate of the ratio of the light that reaches shadows by way of one surface to the
/// unobstructed light of a lamp, as it irradiates edges, over the probability of that lamp by its power.
/// Points in shadow that are visible from the sensor are taken as matt, and the lower quartile of their
/// ratios is the result. It is 0 if the ratio is unknown: if few of the points lie in shadow, and in scenes
/// with media or surfaces that transmit light. `w`: any wavelengths.
float light_in_shadows(const DiffractionInput& scene, const SceneEdges& edges, const LitEdges& lit_edges,
                       const Wavelengths& w);

}  // namespace aureole
