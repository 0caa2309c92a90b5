// SPDX-License-Identifier: Apache-2.0
// Defaults of the emitter interface: an emitter that is not on a shape and not at infinity.
#include "aureole/emitter/emitter.h"

#include "aureole/plugin/properties.h"

namespace aureole {

void Emitter::attach(const Shape&) {
  throw Error(properties().where(),
              "an emitter of type \"" + properties().type() + "\" cannot sit on a shape; use \"area\"");
}
void Emitter::set_scene_bounds(const Vec3&, float) {}
std::size_t Emitter::part_of(const SurfacePoint&) const { return 0; }
Spectrum Emitter::eval(const SurfacePoint&, const Vec3&, const Wavelengths&) const { return 0.f; }
Spectrum Emitter::eval_escaped(const Vec3&, const Wavelengths&) const { return 0.f; }
float Emitter::pdf_direct(const Vec3&, const SurfacePoint&) const { return 0; }
float Emitter::pdf_direct_escaped(const Vec3&, const Vec3&) const { return 0; }

}  // namespace aureole
