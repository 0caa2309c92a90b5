// SPDX-License-Identifier: Apache-2.0
// Instancing: a group of shapes has its own acceleration structure and appears in the scene any number of
// times.
#pragma once

#include "aureole/asset/asset.h"

namespace aureole {

class PlacedMedia;

/// Shapes in local coordinates. The group itself is not rendered. Nested groups, instances and shapes of
/// several primitives are flattened, because Embree is built with one level of instances.
class ShapeGroup final : public Asset {
public:
  /// A group nested in this one.
  struct Nested {
    std::shared_ptr<const ShapeGroup> group;
    Transform to_group;
  };

  explicit ShapeGroup(const Properties& properties);

  /// The group's own shapes, without those of nested groups.
  const std::shared_ptr<const ShapeList>& list() const { return list_; }
  const std::vector<Nested>& nested() const { return nested_; }
  /// Returns the number of instances that one instance of the group adds to the scene, nested groups included.
  double instance_count() const { return instance_count_; }

private:
  void add(const Asset& asset);
  /// Adds a shape of another list.
  void add(const ShapeList& other, std::size_t i);

  ShapeList own_;  ///< list of the group's own shapes, used while the group is assembled
  std::shared_ptr<const ShapeList> list_;
  std::vector<Nested> nested_;
  double instance_count_ = 0;
};

/// An instance of a group: one instance of the group's own shapes, and one of every nested group.
class InstanceAsset final : public Asset {
public:
  explicit InstanceAsset(const Properties& properties);

  const std::shared_ptr<const ShapeGroup>& group() const { return group_; }
  const Transform& to_world() const { return motion_.first(); }
  bool is_moving() const { return motion_.is_moving(); }

private:
  /// `to_outer` maps the coordinates of `group` to those of the instance's own group. `around`: the media of the
  /// instance that contains `group`, or null.
  void take_apart(const ShapeGroup& group, const Transform& to_outer, const PlacedMedia* around);
  void note_media(const Instance& instance, const PlacedMedia& media);

  std::shared_ptr<const ShapeGroup> group_;
  Motion motion_;
};

}  // namespace aureole
