// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/shape.h"

#include <unordered_set>

#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/shape_docs.h"
#include "aureole/texture/texture.h"

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

/// Adds the textures that show attributes from an object's parameters downwards.
void collect(const Properties& properties, std::unordered_set<const Object*>& seen,
             std::vector<const AttributeTexture*>& found) {
  for (const Properties::Entry& e : properties.entries()) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    if (!object || !seen.insert(object->get()).second) continue;
    if (const auto* texture = dynamic_cast<const AttributeTexture*>(object->get())) found.push_back(texture);
    collect((*object)->properties(), seen, found);
  }
}

}  // namespace

std::vector<const AttributeTexture*> Shape::attribute_textures(const Properties& properties) {
  std::unordered_set<const Object*> seen;
  std::vector<const AttributeTexture*> found;
  collect(properties, seen, found);
  return found;
}

Shape::Children Shape::read_children(const Properties& properties) {
  Children c;
  c.emitter = only_child<Emitter>(properties, "emitter");
  c.sensor = only_child<Sensor>(properties, "sensor");
  c.bsdf = only_child<Bsdf>(properties, "bsdf");
  c.default_bsdf = !c.bsdf;
  if (!c.bsdf) c.bsdf = default_bsdf(properties, c.emitter != nullptr);
  return c;
}

bool Shape::can_adopt(const Properties& properties, const Children& children) const {
  // Patches are made for emitters, attributes are kept for the textures that show them, and materials of a
  // file take the place of a default. A sensor is the scene's while it is put together.
  return bsdf_ && !parts() && !sensor_ && !children.sensor &&
         (emitter_ != nullptr) == (children.emitter != nullptr) &&
         has_default_bsdf_ == children.default_bsdf && attribute_textures(this->properties()).empty() &&
         attribute_textures(properties).empty();
}

void Shape::exchange_children(std::shared_ptr<const Properties>& properties, Children& children) {
  exchange_properties(properties);
  Children own{std::move(bsdf_), std::move(emitter_), std::move(sensor_), has_default_bsdf_};
  take(std::move(children));
  children = std::move(own);
}

void Shape::take(Children children) {
  bsdf_ = std::move(children.bsdf), emitter_ = std::move(children.emitter);
  sensor_ = std::move(children.sensor), has_default_bsdf_ = children.default_bsdf;
  ask_bsdf();
}

Shape::Shape(const Properties& properties, Attributes attributes) : Object(properties) {
  take(read_children(properties));
  if (attributes == Attributes::none)
    for (const AttributeTexture* t : attribute_textures(properties))
      throw Error(t->properties().where(), "a \"" + properties.type() + "\" has no attribute \"" +
                                               t->attribute_name() + "\"; only meshes have attributes");
  properties.get_float("silhouette_sampling_weight", 1);
  if (properties.has("silhouette_sampling_weight"))
    properties.note("silhouette_sampling_weight", "has no effect: there is no differentiable rendering");
}

Shape::Shape(const Properties& properties, BsdfPtr bsdf) : Object(properties), bsdf_(std::move(bsdf)) {
  if (bsdf_) ask_bsdf();
}

void Shape::ask_bsdf() {
  lobes_ = bsdf_->lobes();
  needs_tangent_ = bsdf_->needs_tangent();
  needs_choice_ = bsdf_->needs_choice();
}

Shape::~Shape() = default;

Spectrum Shape::attribute(const Texture&, const SurfacePoint&, const Wavelengths&) const { return 0.f; }

std::vector<ParameterDoc> shape_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"bsdf", "bsdf", "", "diffuse of reflectance 0.5, or 0 on an emitter", "What the surface is made of."});
  own.push_back({"emitter", "emitter", "", "none", "Makes the surface shine; usually an area emitter."});
  own.push_back({"sensor", "sensor", "", "none", "Measures on the surface: an irradiancemeter."});
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
