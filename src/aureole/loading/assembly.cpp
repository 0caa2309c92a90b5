// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/assembly.h"

#include <algorithm>
#include <stdexcept>

#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"

namespace aureole {

namespace {

template <class T>
std::shared_ptr<const T> typed(const ObjectPtr& object) {
  auto found = std::dynamic_pointer_cast<const T>(object);
  if (!found)
    throw std::logic_error("the plug-in \"" + object->properties().type() +
                           "\" is registered in a wrong family");
  return found;
}

}  // namespace

void SceneAssembly::run(const Node& root, bool needs_sensor) {
  check_attributes(root, {}, {"version", "id", "name", "type"}, diagnostics_);
  for (const Node& child : root.children) add(child);
  // A shape that could not be built may contain the sensor.
  if (!sensor_ && needs_sensor && !shape_failed_) diagnostics_.error(root.where, "the scene has no <sensor>");
}

void SceneAssembly::add(const Node& child) {
  if (is_property(child)) {
    const std::vector<std::string> known = {"length_unit", "energy_preserving"};
    if (std::find(known.begin(), known.end(), child.get("name")) == known.end())
      diagnostics_.error(child.where, "unknown parameter \"" + child.get("name") + "\" of the scene" +
                                          did_you_mean(child.get("name"), known));
    return;
  }
  if (child.tag == "alias") return;
  if (child.tag == "given") {  // the object is built, since references may name it
    builder_.object(child);
    return;
  }
  const Node* node = builder_.target(child);
  if (!node) return;  // the <ref> is invalid, which has been reported
  const std::string family = object_family(*node);
  if (family.empty()) {
    diagnostics_.error(unknown_element(*node));
  } else if (family == "sensor" && sensor_) {
    if (node != sensor_ && !references_.is_nested(*node))
      diagnostics_.note(node->where, "only the first sensor is used; this one is ignored");
  } else if (family == "integrator" && integrator_) {
    if (node != integrator_)
      diagnostics_.error(node->where,
                         "a scene has one integrator: the first is at " + integrator_->where.str());
  } else {
    keep(*node, family, builder_.object(*node));
  }
}

void SceneAssembly::keep(const Node& node, const std::string& family, const ObjectPtr& object) {
  if (family == "sensor") sensor_ = &node;
  if (family == "integrator") integrator_ = &node, integrator = object;
  if (!object) {
    shape_failed_ |= family == "shape";
    return;
  }
  if (family == "sensor") parts.sensor = typed<Sensor>(object);
  if (family == "shape") {
    const auto asset = typed<Asset>(object);
    append_primitives(node, *asset);
    take_sensor(node, *asset);
  }
  if (family != "emitter" || references_.is_nested(node)) return;
  const auto emitter = typed<Emitter>(object);
  if (emitter->sits_on_shape())
    diagnostics_.note(node.where, "no shape uses this emitter: it has no effect");
  else if (appended_.insert(object.get()).second)
    parts.emitters.push_back(emitter);
}

void SceneAssembly::take_sensor(const Node& node, const Asset& asset) {
  if (!asset.sensor()) return;
  if (!sensor_) {
    sensor_ = &node, parts.sensor = asset.sensor(), parts.sensor_area = asset.sensor_area();
  } else if (parts.sensor != asset.sensor()) {
    if (!references_.is_nested(node))
      diagnostics_.note(asset.sensor()->properties().where(),
                        "only the first sensor is used; this one is ignored");
  } else if (!parts.sensor_area) {
    parts.sensor_area = asset.sensor_area();
  } else if (parts.sensor_area != asset.sensor_area()) {
    diagnostics_.error(asset.sensor()->properties().where(),
                       "this irradiance meter sits on two shapes; give each its own");
  }
}

void SceneAssembly::append_primitives(const Node& node, const Asset& asset) {
  if (asset.primitives().empty() && !references_.is_nested(node))
    diagnostics_.note(node.where, "nothing of this " + node.get("type") + " is rendered: it has no effect");
  if (!appended_.insert(&asset).second) return;
  for (const std::string& note : asset.placement_notes()) asset.properties().note("to_world", note);
  parts.surfaces.insert(parts.surfaces.end(), asset.primitives().begin(), asset.primitives().end());
}

}  // namespace aureole
