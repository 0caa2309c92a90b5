// SPDX-License-Identifier: Apache-2.0
// The splats of a scene, and the scenes that the integrator `splat` can show.
#pragma once

#include <vector>

#include "aureole/integrator/splat/splat_settings.h"
#include "aureole/medium/splats/splat_medium.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// Returns the media of the type "splats", in the order of the scene.
std::vector<const SplatMedium*> splat_media(const Scene& scene);

/// Whether splats are followed along each ray instead of projected: by choice, or since the sensor has no centre of projection.
bool follows_rays(const Scene& scene, const SplatSettings& settings);

/// Throws a located Error where the scene has no splats, media of other types, splats of different conventions, or a sensor that
/// the settings cannot serve. `properties` are those of the integrator.
void require_splat_scene(const Scene& scene, const SplatSettings& settings, const Properties& properties);

}  // namespace aureole
