// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/shape_group.h"

namespace aureole {

ShapeGroup::ShapeGroup(const Properties& properties) : Asset(properties) {
  for (const auto& child : properties.get_children<Asset>("shape")) {
    add(*child);
    // The scene reports the repairs of its own shapes, but not of shapes inside groups, so they are noted
    // here.
    if (Diagnostics* diagnostics = properties.context().diagnostics)
      for (const Primitive& primitive : child->primitives())
        for (const std::string& remark : primitive.remarks)
          diagnostics->note(child->properties().where(), remark);
  }
  if (own_.shapes.empty() && nested_.empty()) properties.note("shape", "the group holds no shapes");
  instance_count_ = own_.shapes.empty() ? 0 : 1;
  for (const Nested& n : nested_) instance_count_ += n.group->instance_count();
  list_ = std::make_shared<const ShapeList>(std::move(own_));
}

void ShapeGroup::add(const Asset& asset) {
  if (const auto& sensor = asset.sensor())
    throw Error(sensor->properties().where(), "a shape of a group cannot be a sensor");
  if (const auto* group = dynamic_cast<const ShapeGroup*>(&asset)) {
    for (std::size_t i = 0; i < group->list_->shapes.size(); ++i) add(*group->list_, i);
    nested_.insert(nested_.end(), group->nested_.begin(), group->nested_.end());
  } else if (const auto* instance = dynamic_cast<const InstanceAsset*>(&asset)) {
    if (instance->is_moving())
      throw instance->properties().error("to_world",
                                         "an instance within a group cannot move: move the outer one");
    nested_.push_back({instance->group(), instance->to_world()});
  } else {
    for (const Primitive& primitive : asset.primitives()) {
      own_.shapes.push_back(primitive.shape), own_.bsdfs.push_back(primitive.bsdf);
      own_.media.push_back(primitive.media), own_.elements.push_back(primitive.element);
      own_.emitters.push_back(primitive.emitter), own_.areas.push_back(primitive.area);
      own_.is_part_of_closed.push_back(primitive.is_part_of_closed);
      own_.bounds.extend(primitive.shape->bounds());
    }
  }
}

void ShapeGroup::add(const ShapeList& other, std::size_t i) {
  own_.shapes.push_back(other.shapes[i]), own_.bsdfs.push_back(other.bsdfs[i]);
  own_.media.push_back(other.media[i]), own_.elements.push_back(other.elements[i]);
  own_.emitters.push_back(other.emitters[i]), own_.areas.push_back(other.areas[i]);
  own_.is_part_of_closed.push_back(other.is_part_of_closed[i]);
  own_.bounds.extend(other.shapes[i]->bounds());
}

AUREOLE_PLUGIN(
    ShapeGroup, "shape", "shapegroup",
    PluginDoc{
        .summary =
            "Shapes that `instance` puts into the scene, any number of times, with the memory of one copy. "
            "The group itself is not rendered. Its shapes keep their own BSDFs and emitters; instances of a group that emits may be turned and moved only. "
            "Groups and instances within a group are allowed.",
        .source = "",
        .parameters = {{"shape", "shape", "", "none", "any number of shapes"}},
        .examples = {R"(<shape type="shapegroup" id="tree">
  <shape type="cylinder"><float name="radius" value="0.1"/></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z="1.5"/></shape>
</shape>)"},
        .takes_shared_parameters = false});

}  // namespace aureole
