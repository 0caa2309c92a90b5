// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/splat_scene.h"

#include "aureole/integrator/splat/projected_splats.h"

namespace aureole {

namespace {

/// Throws a located Error where the sensor has no centre of projection and the settings need one.
void require_sensor(const Scene& scene, const SplatSettings& settings) {
  const Properties& sensor = scene.sensor().sensor->properties();
  if (scene.sensor().sensor->medium())
    throw Error(sensor.where(), "\"splat\" passes no medium: state none on the sensor");
  if (scene.sensor().pinhole()) return;
  if (!settings.blends())
    throw Error(
        sensor.where(),
        "points are projected through one point: use the sensor \"perspective\", or the footprint \"3dgs\" for "
        "Gaussian splats, which rays can follow");
  if (settings.method == SplatSettings::Method::projection)
    throw Error(
        sensor.where(),
        "splats are projected through one point: use the sensor \"perspective\", or the method \"rays\"");
}

}  // namespace

std::vector<const SplatMedium*> splat_media(const Scene& scene) {
  std::vector<const SplatMedium*> media;
  for (const Medium* medium : scene.media())
    if (const auto* splats = dynamic_cast<const SplatMedium*>(medium)) media.push_back(splats);
  return media;
}

bool follows_rays(const Scene& scene, const SplatSettings& settings) {
  return settings.method == SplatSettings::Method::rays ||
         (settings.method == SplatSettings::Method::automatic && !scene.sensor().pinhole());
}

void require_splat_scene(const Scene& scene, const SplatSettings& settings, const Properties& properties) {
  const auto media = splat_media(scene);
  if (media.empty())
    throw Error(properties.where(),
                "\"splat\" shows media of the type \"splats\", and the scene has none: give a shape "
                "<medium type=\"splats\" name=\"interior\">");
  for (const Medium* medium : scene.media())
    if (!dynamic_cast<const SplatMedium*>(medium))
      throw Error(
          medium->properties().where(),
          "\"splat\" shows media of the type \"splats\" alone; this one would not be seen before or within them");
  require_sensor(scene, settings);
  SplatConventions::of(media, settings, properties);
  const bool needs_extent = settings.footprint != SplatSettings::Footprint::point && !settings.blends();
  const bool rays = follows_rays(scene, settings);
  for (const SplatMedium* medium : media) {
    if (medium->emission_scale() != media.front()->emission_scale())
      throw medium->properties().error("emission_scale",
                                       "splats that are blended together have one scale of their light");
    if (rays && medium->cloud().kind == SplatCloud::Kind::points)
      throw medium->properties().error("filename", "holds points; rays see Gaussian splats");
    if (!needs_extent) continue;
    for (const Vec3& s : medium->cloud().scales)
      if (!(max_component(s) > 0))
        throw medium->properties().error(
            "radius", "points without a radius have no footprint but \"point\": state their radius");
  }
}

}  // namespace aureole
