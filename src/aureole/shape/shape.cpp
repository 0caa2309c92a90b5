// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/shape.h"

#include <stdexcept>

#include "aureole/plugin/registry.h"

namespace aureole {

Shape::Shape(const Properties& properties) : Object(properties) {
  properties.get_float("silhouette_sampling_weight", 1);
  if (properties.has("silhouette_sampling_weight"))
    properties.note("silhouette_sampling_weight", "has no effect: there is no differentiable rendering");
}

Error Shape::no_attribute(const SourceLocation& where, const std::string& name) const {
  return Error(where, "a \"" + properties().type() + "\" has no attribute \"" + name +
                          "\"; only meshes have attributes");
}

std::vector<std::shared_ptr<const Shape>> Shape::split(std::span<const std::size_t>) const {
  throw std::logic_error("a \"" + properties().type() + "\" has no materials to be divided by");
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "shape",
    .parameters = {
        {"bsdf", "bsdf", "", "diffuse of reflectance 0.5, or 0 on an emitter", "material of the surface"},
        {"bssrdf", "bssrdf", "", "none",
         "subsurface scattering by a BSSRDF: light enters at one point of the surface and leaves at "
         "another. It replaces a medium inside and has its own boundary BSDF"},
        {"emitter", "emitter", "", "none", "emitter on the surface, usually an area emitter"},
        {"sensor", "sensor", "", "none", "sensor on the surface: an irradiancemeter"},
        {"interior", "medium", "", "none", "medium on the side opposite to the normal"},
        {"exterior", "medium", "", "none", "medium on the side of the normal"},
        {"priority", "integer", "", "0",
         "nested dielectrics: where closed shapes overlap, the one with the highest priority (up to 127) "
         "fills the common volume, and the surfaces of the others are inactive there; 0: none is stated (docs/media.md says what holds where such "
         "bodies touch or overlap)"},
        {"to_world", "transform", "", "identity", "transform from local coordinates to world space"},
        {"flip_normals", "boolean", "", "false", "reverse the normals, and with them the emitting side"},
        {"silhouette_sampling_weight", "float", "", "1",
         "accepted for compatibility with Mitsuba, without effect"}}});

}  // namespace aureole
