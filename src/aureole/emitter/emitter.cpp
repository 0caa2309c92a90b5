// SPDX-License-Identifier: Apache-2.0
// Defaults of the emitter interface: an emitter that is neither on a shape nor at infinity.
#include "aureole/emitter/emitter.h"

#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

ModulationPtr only_modulation(const Properties& p) {
  const auto found = p.get_children<Modulation>("modulation");
  if (found.size() > 1) throw Error(found[1]->properties().where(), "an emitter has one modulation");
  return found.empty() ? nullptr : found.front();
}

}  // namespace

Emitter::Emitter(const Properties& properties)
    : Object(properties),
      sampling_weight_(float(properties.get_float("sampling_weight", 1, {0, 1e9}))),
      medium_(only_medium(properties)),
      modulation_(only_modulation(properties)) {}

bool Emitter::sits_on_shape() const {
  const PluginInfo* plugin = properties().plugin();
  return plugin && plugin->doc.needs_shape;
}

Spectrum Emitter::eval(const SurfacePoint&, const Vec3&, const Wavelengths&) const { return 0.f; }
Spectrum Emitter::eval_escaped(const Vec3&, const Wavelengths&) const { return 0.f; }
float Emitter::pdf_direct(const Light&, const Vec3&, std::size_t, const SurfacePoint&) const { return 0; }
float Emitter::pdf_direct_escaped(const Vec3&, const Vec3&, const Vec3&) const { return 0; }

EmittedRay ray_from_infinity(const Light& light, const Vec3& d, Vec2 position) {
  const Vec2 disc = square_to_disc_concentric(position).p;
  EmittedRay r;
  r.p = light.scene_center + Frame::from_normal(d).to_world({disc.x, disc.y, -1}) * light.scene_radius;
  r.d = d;
  r.pdf_position = density_from_infinity(light, 0).position;
  return r;
}

RayDensity density_from_infinity(const Light& light, float direction) {
  return {square_to_disc_pdf() / (light.scene_radius * light.scene_radius), direction};
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "emitter",
    .parameters =
        {{"medium", "medium", "", "the medium inside the surfaces around it",
          "medium around the emitter; needed only if no surface bounds that medium"},
         {"sampling_weight", "float", "", "1",
          "factor of the probability that light sampling chooses this emitter; 0: never, so that only "
          "rays that hit it by chance find it"},
         {"modulation", "modulation", "", "none", "how the light changes over time"}},
    .belongs_to_shapes = true,
    .is_reusable = true});

}  // namespace aureole
