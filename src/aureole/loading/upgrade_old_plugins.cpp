// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade_old_plugins.h"

#include <algorithm>

#include "aureole/core/letter_case.h"
#include "aureole/core/units.h"
#include "aureole/loading/values.h"

namespace aureole {

namespace {

Node made(const Node& near, std::string_view tag, std::string_view attribute, std::string_view value) {
  Node node{std::string(tag), {}, {}, near.where, near.file};
  node.set(std::string(attribute), std::string(value));
  return node;
}

/// Removes the child of this name and returns it.
std::optional<Node> taken(Node& object, std::string_view name) {
  const auto found = std::find_if(object.children.begin(), object.children.end(),
                                  [&](const Node& child) { return child.get("name") == name; });
  if (found == object.children.end()) return {};
  Node child = std::move(*found);
  object.children.erase(found);
  return child;
}

void drop(Node& object, std::string_view name, Diagnostics& diagnostics) {
  if (const auto child = taken(object, name))
    diagnostics.note(child->where, "\"" + std::string(name) + "\" has no effect and is ignored");
}

double number_in(const std::optional<Node>& child, double fallback) {
  return child ? parse_number(child->get("value")) : fallback;
}

void note_replaced(const Node& object, const std::string& by, Diagnostics& diagnostics) {
  diagnostics.note(object.where,
                   object.tag + " \"" + object.get("type") + "\" is replaced by \"" + by + "\"");
}

/// Converts a smooth or rough coating of any thickness, which absorbs exp(-sigma_a thickness / cos) each way,
/// into a layer of 10 um of the same optical thickness (a scene of 0.6 has no unit of length but the metre).
void upgrade_coating(Node& coating, Diagnostics& diagnostics) {
  constexpr double kThicknessM = 1e-5;
  note_replaced(coating, "layered", diagnostics);
  drop(coating, "specular_reflectance", diagnostics);
  drop(coating, "sample_visible", diagnostics);
  drop(coating, "specular_sampling_weight", diagnostics);
  const double thickness = number_in(taken(coating, "thickness"), 1);
  std::optional<Node> absorption = taken(coating, "sigma_a");
  Node medium = made(coating, "medium", "type", "homogeneous");
  if (absorption)
    absorption->set("name", "sigma_t");
  else
    absorption = parameter_node(coating, "float", "sigma_t", "0");
  medium.children.push_back(std::move(*absorption));
  medium.children.push_back(parameter_node(coating, "float", "albedo", "0"));
  medium.children.push_back(parameter_node(coating, "float", "scale", number_text(thickness / kThicknessM)));
  if (coating.get("type") == "roughcoating") {
    Node* alpha = coating.named_child("alpha");
    if (!alpha) coating.children.push_back(parameter_node(coating, "string", "alpha", "0.1"));
    if (alpha && alpha->tag == "float") {
      double a = parse_number(alpha->get("value"));
      if (a > 0 && a < 0.05) {
        diagnostics.note(alpha->where, "a coating of alpha " + number_text(a) +
                                           " is read as smooth: \"layered\" has 0 or 0.05 to 1");
        a = 0;
      }
      *alpha = parameter_node(*alpha, "string", "alpha", number_text(a));
    }
  } else {
    coating.children.push_back(parameter_node(coating, "string", "alpha", "0"));
  }
  if (!coating.named_child("int_ior"))
    coating.children.push_back(parameter_node(coating, "string", "int_ior", "bk7"));
  coating.set("type", "layered");
  coating.children.push_back(parameter_node(coating, "string", "thickness", "10um"));
  coating.children.push_back(std::move(medium));
}

/// Converts `hair`; its file has no radii, so that a default radius is used.
void upgrade_hair(Node& hair, Diagnostics& diagnostics) {
  note_replaced(hair, "linearcurve", diagnostics);
  hair.set("type", "linearcurve");
  drop(hair, "angle_threshold", diagnostics);
  drop(hair, "reduction", diagnostics);
  if (!hair.named_child("radius")) hair.children.push_back(parameter_node(hair, "float", "radius", "0.025"));
}

/// Converts a beam of zero width, whose power is 1 unless stated, to the light of a small disc.
void upgrade_collimated(Node& beam, Diagnostics& diagnostics) {
  constexpr double kRadius = 1e-3, kArea = 3.14159265358979 * kRadius * kRadius;
  const auto power = taken(beam, "power");
  if (power && power->tag != "float") {
    diagnostics.error(power->where,
                      "the power of a collimated beam must be a number here; a disk with the emitter "
                      "\"directionalarea\" takes any spectrum");
    return;
  }
  diagnostics.note(beam.where,
                   "emitter \"collimated\" is replaced by a disk of radius 0.001 with the emitter "
                   "\"directionalarea\"; ptracer and bdpt find its light");
  Node emitter = made(beam, "emitter", "type", "directionalarea");
  emitter.children.push_back(
      parameter_node(beam, "float", "radiance", number_text(number_in(power, 1) / kArea)));
  for (const char* name : {"sampling_weight", "medium"})
    if (auto child = taken(beam, name)) emitter.children.push_back(std::move(*child));
  auto to_world = taken(beam, "to_world");
  if (!to_world) to_world = made(beam, "transform", "name", "to_world");
  Node scale = made(beam, "scale", "value", number_text(kRadius));
  to_world->children.insert(to_world->children.begin(), std::move(scale));
  beam.tag = "shape";
  beam.set("type", "disk");
  beam.children.push_back(std::move(*to_world));
  beam.children.push_back(std::move(emitter));
}

/// Drops an environment map's `gamma` where it has no effect: pictures of floats are linear, and 8-bit ones
/// are encoded in sRGB, which 2.2 approximates.
void upgrade_envmap(Node& map, Diagnostics& diagnostics) {
  drop(map, "cache", diagnostics);
  drop(map, "cache_size", diagnostics);
  const Node *gamma = map.named_child("gamma"), *file = map.named_child("filename");
  if (!gamma) return;
  const std::string name = lower_case(file ? file->get("value") : "");
  const bool linear =
      name.ends_with(".exr") || name.ends_with(".hdr") || name.ends_with(".rgbe") || name.ends_with(".pfm");
  const std::string value = gamma->get("value");
  if (!linear && value != "-1" && value != "0" && value != "2.2") {
    diagnostics.error(gamma->where, "a gamma of " + value +
                                        " is not supported: 8-bit pictures are sRGB; convert the map to EXR");
    return;
  }
  drop(map, "gamma", diagnostics);
}

/// Three numbers are the components of an RGB colour, as in most builds of Mitsuba 0.6.
void upgrade_spectrum(Node& node, Diagnostics& diagnostics) {
  const Attribute* value = node.find("value");
  if (!value || value->failed || value->value.find(':') != std::string::npos) return;
  if (split_list(value->value).size() != 3) return;
  diagnostics.note(value->where, "three numbers of a <spectrum> are read as <rgb>");
  node.tag = "rgb";
}

/// Replaces a `volcache` by the volume in it.
void upgrade_volcache(Node& cache, Diagnostics& diagnostics) {
  const auto inner = std::find_if(cache.children.begin(), cache.children.end(),
                                  [](const Node& c) { return c.tag == "volume" || c.tag == "ref"; });
  if (inner == cache.children.end()) return;
  diagnostics.note(cache.where, "volume \"volcache\" is replaced by the volume in it");
  Node volume = std::move(*inner);
  volume.set("name", cache.get("name"));
  if (cache.find("id") && volume.tag == "volume") volume.set("id", cache.get("id"));
  cache = std::move(volume);
}

}  // namespace

void upgrade_old_plugin(Node& object, Diagnostics& diagnostics) {
  const std::string type = object.get("type");
  try {
    if (object.tag == "spectrum" && type.empty()) upgrade_spectrum(object, diagnostics);
    if (object.tag == "bsdf" && (type == "coating" || type == "roughcoating"))
      upgrade_coating(object, diagnostics);
    if (object.tag == "shape" && type == "hair") upgrade_hair(object, diagnostics);
    if (object.tag == "emitter" && type == "collimated") upgrade_collimated(object, diagnostics);
    if (object.tag == "emitter" && type == "envmap") upgrade_envmap(object, diagnostics);
    if (object.tag == "volume" && type == "volcache") upgrade_volcache(object, diagnostics);
  } catch (const Error& e) {
    diagnostics.error(object.where, "\"" + type + "\": " + e.message());
  }
  if (object.tag == "film" && (type == "tiledhdrfilm" || type == "mfilm")) {
    note_replaced(object, "hdrfilm", diagnostics);
    object.set("type", "hdrfilm");
  }
  if (object.tag == "texture" && type == "vertexcolors") {
    note_replaced(object, "mesh_attribute", diagnostics);
    object.set("type", "mesh_attribute");
    object.children.push_back(parameter_node(object, "string", "name", "vertex_color"));
  }
  if (object.tag == "medium")
    for (Node& child : object.children)
      if (child.get("name") == "density") child.set("name", "sigma_t");
}

}  // namespace aureole
