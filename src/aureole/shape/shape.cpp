// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/shape.h"

#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape_docs.h"

namespace aureole {

namespace {

/// As Mitsuba: a surface without a BSDF is a diffuse one of reflectance .5, and a black one where it emits.
BsdfPtr default_bsdf(const Properties& properties, bool emits) {
  const PluginInfo* diffuse = Registry::instance().find("bsdf", "diffuse");
  if (!diffuse) throw std::logic_error("the bsdf plug-in \"diffuse\" is not registered");
  Properties p("diffuse", "", properties.where(), properties.shared_context(), diffuse);
  p.add("reflectance", emits ? 0.0 : 0.5, properties.where());
  return std::dynamic_pointer_cast<const Bsdf>(diffuse->create(p));
}

template <class T>
std::shared_ptr<T> only_child(const Properties& properties, const char* name) {
  const auto children = properties.get_children<T>(name);
  if (children.size() > 1)
    throw Error(properties.where(), "\"" + properties.type() + "\" has " + std::to_string(children.size()) +
                                        " " + name + " children; a shape has at most one");
  return children.empty() ? nullptr : children.front();
}

}  // namespace

Shape::Shape(const Properties& properties) : Object(properties) {
  emitter_ = only_child<Emitter>(properties, "emitter");
  bsdf_ = only_child<Bsdf>(properties, "bsdf");
  if (!bsdf_) bsdf_ = default_bsdf(properties, emitter_ != nullptr);
  properties.get_float("silhouette_sampling_weight", 1);
  if (properties.has("silhouette_sampling_weight"))
    properties.note("silhouette_sampling_weight", "has no effect: there is no differentiable rendering");
}

Shape::Shape(const Properties& properties, BsdfPtr bsdf) : Object(properties), bsdf_(std::move(bsdf)) {}

Shape::~Shape() = default;

Spectrum Shape::attribute(const Texture&, const SurfacePoint&, const Wavelengths&) const { return 0.f; }

std::vector<ParameterDoc> shape_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"bsdf", "bsdf", "", "diffuse of reflectance 0.5, or 0 on an emitter", "What the surface is made of."});
  own.push_back({"emitter", "emitter", "", "none", "Makes the surface shine; usually an area emitter."});
  own.push_back(
      {"to_world", "transform", "", "identity", "From the shape's own coordinates to those of the scene."});
  own.push_back(
      {"flip_normals", "boolean", "", "false", "Turns the normals, and with them the shining side, around."});
  own.push_back(
      {"silhouette_sampling_weight", "float", "", "1", "Accepted for Mitsuba's sake, has no effect."});
  return own;
}

std::vector<ParameterDoc> mesh_parameters(std::vector<ParameterDoc> own) {
  own.push_back({"face_normals", "boolean", "", "false", "Ignores vertex normals: a faceted look."});
  return shape_parameters(std::move(own));
}

}  // namespace aureole
