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
        {"bsdf", "bsdf", "", "diffuse of reflectance 0.5, or 0 on an emitter",
         "What the surface is made of."},
        {"bssrdf", "bssrdf", "", "none",
         "A translucent body, by the places at which light leaves that has entered: in place of a medium inside. "
         "It has the boundary's BSDF."},
        {"emitter", "emitter", "", "none", "Makes the surface shine; usually an area emitter."},
        {"sensor", "sensor", "", "none", "Measures on the surface: an irradiancemeter."},
        {"interior", "medium", "", "none",
         "What fills the space on the side of the surface that its normal points away from."},
        {"exterior", "medium", "", "none", "What fills the space on the side of the normal."},
        {"priority", "integer", "", "0",
         "Of closed shapes that overlap, the one with the highest priority (up to 127) fills the space that they "
         "share, and the surfaces of the others are not there; 0: takes no part."},
        {"to_world", "transform", "", "identity", "From the shape's own coordinates to those of the scene."},
        {"flip_normals", "boolean", "", "false",
         "Turns the normals, and with them the shining side, around."},
        {"silhouette_sampling_weight", "float", "", "1", "Accepted for Mitsuba's sake, has no effect."}}});

}  // namespace aureole
