// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>

#include "aureole/asset/placed_media.h"
#include "aureole/asset/shape_group.h"

namespace aureole {

InstanceAsset::InstanceAsset(const Properties& properties) : Asset(properties) {
  const auto groups = properties.get_children<ShapeGroup>("shapegroup");
  if (groups.size() != 1)
    throw Error(properties.where(), "an instance needs one shapegroup: write <ref id=\"...\"/> with its id");
  group_ = groups.front();
  motion_ = properties.get_motion("to_world");
  // Groups in groups multiply: 40 of them, each with two instances of the one before, are 10^12 instances.
  constexpr double kMostInstances = 2e6;
  if (const double count = group_->instance_count(); count > kMostInstances)
    throw Error(
        properties.where(),
        fmt::format("with the instances within its group this is {:.3g} instances of shapes; at most {:.3g} "
                    "can be placed",
                    count, kMostInstances));
  take_apart(*group_, Transform(), nullptr);
}

void InstanceAsset::take_apart(const ShapeGroup& group, const Transform& to_outer,
                               const PlacedMedia* around) {
  std::optional<PlacedMedia> media;
  if (!group.list()->shapes.empty()) {
    Primitive primitive;
    primitive.instance =
        std::make_shared<const Instance>(group.list(), group.list()->bounds, motion_, to_outer, properties());
    primitive.element = shared_properties();
    media.emplace(primitive.instance, around);
    primitive.placed_media = media->of_shapes();
    if (motion_.is_moving()) {
      for (const SurfaceMedia& m : group.list()->media)
        if (m.bssrdf)
          throw Error(m.bssrdf->properties().where(),
                      "a shape with subsurface scattering cannot be moved by key frames");
      if (!primitive.placed_media.empty())
        throw properties().error("to_world",
                                 "moves a medium that is not the same everywhere: key frames cannot do that");
    }
    note_media(*primitive.instance, *media);
    primitives_.push_back(std::move(primitive));
  }
  for (const ShapeGroup::Nested& n : group.nested())
    take_apart(*n.group, to_outer * n.to_group, media ? &*media : around);
}

void InstanceAsset::note_media(const Instance& instance, const PlacedMedia& media) {
  if (media.has_oriented_particles() && !keeps_angles(instance))
    placement_notes_.push_back(
        "stretches a group with a medium of oriented particles: they are turned with it, but keep their "
        "shape");
  for (const MediumPtr& medium : media.not_moved()) {
    const Properties& p = medium->properties();
    placement_notes_.push_back(
        fmt::format("a shape of the group has the medium{} at {} as its exterior, which is not the same "
                    "everywhere and fills no shape of the group: it keeps its place in the scene and does "
                    "not move with the instance",
                    p.id().empty() ? "" : " \"" + p.id() + "\"", p.where().str()));
  }
}

AUREOLE_PLUGIN(
    InstanceAsset, "shape", "instance",
    PluginDoc{
        .summary =
            "One appearance of a `shapegroup` in the scene. Its shapes have the BSDFs that they have in "
            "the group. Any affine to_world is allowed, mirroring included. Volumes of its shapes (textures, "
            "media that fill them) have the group's coordinates and move with the instance; oriented "
            "particles are turned, not deformed. Coefficients of media are per length of the scene: an "
            "instance that is twice as large has twice the optical thickness. A medium that only surrounds "
            "shapes of the group keeps its place in the scene.",
        .source = "",
        .parameters =
            {{"shapegroup", "shape", "", "required", "The group, usually by <ref id=\"...\"/>."},
             {"to_world", "transform", "", "identity",
              "From the group's coordinates to those of the scene. An `<animation>` of key frames moves the "
              "instance during the exposure of the sensor."}},
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
