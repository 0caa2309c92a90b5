// SPDX-License-Identifier: Apache-2.0
// Defaults of the emitter interface: an emitter that is not on a shape and not at infinity.
#include "aureole/emitter/emitter.h"

#include "aureole/emitter/emitter_docs.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/properties.h"

namespace aureole {

Emitter::Emitter(const Properties& properties)
    : Object(properties), sampling_weight_(float(properties.get_float("sampling_weight", 1, {0, 1e9}))) {}

void Emitter::attach(const Shape&) {
  throw Error(properties().where(),
              "an emitter of type \"" + properties().type() + "\" cannot sit on a shape; use \"area\"");
}
void Emitter::set_scene_bounds(const Vec3&, float) {}
std::size_t Emitter::part_of(const SurfacePoint&) const { return 0; }
Spectrum Emitter::eval(const SurfacePoint&, const Vec3&, const Wavelengths&) const { return 0.f; }
Spectrum Emitter::eval_escaped(const Vec3&, const Wavelengths&) const { return 0.f; }
float Emitter::pdf_direct(const Vec3&, const SurfacePoint&) const { return 0; }
float Emitter::pdf_direct_escaped(const Vec3&, const Vec3&, const Vec3&) const { return 0; }

EmittedRay ray_from_infinity(const Vec3& scene_center, float scene_radius, const Vec3& d, Vec2 position) {
  const Vec2 disc = square_to_disc_concentric(position).p;
  EmittedRay r;
  r.p = scene_center + Frame::from_normal(d).to_world({disc.x, disc.y, -1}) * scene_radius;
  r.d = d;
  r.pdf_position = square_to_disc_pdf() / (scene_radius * scene_radius);
  return r;
}

std::vector<ParameterDoc> emitter_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"sampling_weight", "float", "", "1",
       "factor of the probability with which light sampling chooses this emitter; 0: never, so that "
       "it is only seen where rays meet it by chance"});
  return own;
}

}  // namespace aureole
