// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/shape_group.h"

namespace aureole {

InstanceAsset::InstanceAsset(const Properties& properties) : Asset(properties) {
  const auto groups = properties.get_children<ShapeGroup>("shapegroup");
  if (groups.size() != 1)
    throw Error(properties.where(), "an instance needs one shapegroup: write <ref id=\"...\"/> with its id");
  group_ = groups.front();
  to_world_ = properties.get_transform("to_world");
  take_apart(*group_, to_world_);
}

void InstanceAsset::take_apart(const ShapeGroup& group, const Transform& to_world) {
  if (!group.list()->shapes.empty()) {
    Primitive primitive;
    primitive.instance =
        std::make_shared<const Instance>(group.list(), group.list()->bounds, to_world, properties());
    primitive.element = shared_properties();
    primitives_.push_back(std::move(primitive));
  }
  for (const ShapeGroup::Nested& n : group.nested()) take_apart(*n.group, to_world * n.to_group);
}

AUREOLE_PLUGIN(
    InstanceAsset, "shape", "instance",
    PluginDoc{
        .summary =
            "One appearance of a `shapegroup` in the scene. Its shapes have the BSDFs that they have in "
            "the group. Any affine to_world is allowed, mirroring included.",
        .source = "",
        .parameters = {{"shapegroup", "shape", "", "required", "The group, usually by <ref id=\"...\"/>."},
                       {"to_world", "transform", "", "identity",
                        "From the group's coordinates to those of the scene."}},
        .examples = {R"(<shape type="instance">
  <shape type="shapegroup">
    <shape type="sphere"/>
  </shape>
  <transform name="to_world">
    <scale x="2" y="1" z="0.5"/>
    <translate x="3"/>
  </transform>
</shape>)"},
        .takes_shared_parameters = false});

}  // namespace aureole
