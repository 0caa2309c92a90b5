// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/shape_group.h"

namespace aureole {

ShapeGroup::ShapeGroup(const Properties& properties) : UnsampledShape(properties, nullptr) {
  for (const ShapePtr& child : properties.get_children<Shape>("shape")) {
    add(child);
    // The scene, which tells the remarks of its shapes, does not see these.
    if (Diagnostics* diagnostics = properties.context().diagnostics)
      for (const std::string& remark : child->remarks())
        diagnostics->note(child->properties().where(), remark);
  }
  if (shapes_.empty() && nested_.empty()) properties.note("shape", "the group holds no shapes");
}

ShapeGroup::~ShapeGroup() { release(); }

void ShapeGroup::release() const {
  if (!scene_) return;
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
  scene_ = nullptr, device_ = nullptr;
}

void ShapeGroup::add(const ShapePtr& shape) {
  if (const Emitter* emitter = shape->emitter())
    throw Error(emitter->properties().where(),
                "a shape of a group cannot be an emitter: instances do not shine");
  if (shape->sensor())
    throw Error(shape->sensor()->properties().where(), "a shape of a group cannot be a sensor");
  passable_ |= shape->is_passable();
  if (const auto* group = dynamic_cast<const ShapeGroup*>(shape.get())) {
    for (const ShapePtr& s : group->shapes_) add(s);
    nested_.insert(nested_.end(), group->nested_.begin(), group->nested_.end());
  } else if (const auto* instance = dynamic_cast<const Instance*>(shape.get())) {
    nested_.push_back({instance->group(), instance->properties().get_transform("to_world")});
  } else if (const std::vector<ShapePtr>* parts = shape->parts()) {
    for (const ShapePtr& part : *parts) add(part);
  } else {
    shapes_.push_back(shape);
    bounds_.extend(shape->bounds());
  }
}

RTCScene ShapeGroup::embree_scene(RTCDevice device) const {
  if (scene_ && device_ == device) return scene_;
  release();
  rtcRetainDevice(device);
  device_ = device;
  scene_ = rtcNewScene(device);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    RTCGeometry geometry = shapes_[i]->make_geometry(device);
    rtcAttachGeometryByID(scene_, geometry, unsigned(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_);
  return scene_;
}

RTCGeometry ShapeGroup::make_geometry(RTCDevice) const {
  throw std::logic_error("a shapegroup is rendered through its instances only");
}

std::size_t ShapeGroup::primitive_count() const {
  std::size_t sum = 0;
  for (const ShapePtr& s : shapes_) sum += s->primitive_count();
  return sum;
}

std::size_t ShapeGroup::memory_bytes() const {
  std::size_t sum = sizeof(*this);
  for (const ShapePtr& s : shapes_) sum += s->memory_bytes();
  return sum;
}

AUREOLE_PLUGIN(
    ShapeGroup, "shape", "shapegroup",
    PluginDoc{
        .summary =
            "Shapes that `instance` puts into the scene, as often as needed, at the cost of one copy. The "
            "group "
            "itself is not rendered. Its shapes keep their own BSDFs; they cannot be emitters. Groups and "
            "instances within a group are allowed.",
        .source = "",
        .parameters = {{"shape", "shape", "", "none", "The shapes, any number of them."}},
        .examples = {R"(<shape type="shapegroup" id="tree">
  <shape type="cylinder"><float name="radius" value="0.1"/></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z="1.5"/></shape>
</shape>)"}});

}  // namespace aureole
