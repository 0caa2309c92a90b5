// SPDX-License-Identifier: Apache-2.0
// Instancing: a group of shapes with an acceleration structure of its own, which stands in the scene many
// times.
#pragma once

#include "aureole/asset/asset.h"

namespace aureole {

/// Shapes in coordinates of their own. Not rendered; nested groups, instances and shapes of several primitives are
/// flattened, because Embree is built for one level of instances.
class ShapeGroup final : public Asset {
public:
  /// Another group that belongs to this one.
  struct Nested {
    std::shared_ptr<const ShapeGroup> group;
    Transform to_group;
  };

  explicit ShapeGroup(const Properties& properties);

  /// Its own shapes, without the nested groups'.
  const std::shared_ptr<const ShapeList>& list() const { return list_; }
  const std::vector<Nested>& nested() const { return nested_; }

private:
  void add(const Asset& asset);
  void add(const ShapePtr& shape, const BsdfPtr& bsdf, const SurfaceMedia& media);

  ShapeList own_;  ///< while the group is put together
  std::shared_ptr<const ShapeList> list_;
  std::vector<Nested> nested_;
};

/// A group in one place of the scene: an instance of its own shapes, and one of every group nested in it.
class InstanceAsset final : public Asset {
public:
  explicit InstanceAsset(const Properties& properties);

  const std::shared_ptr<const ShapeGroup>& group() const { return group_; }
  const Transform& to_world() const { return to_world_; }

private:
  void take_apart(const ShapeGroup& group, const Transform& to_world);

  std::shared_ptr<const ShapeGroup> group_;
  Transform to_world_;
};

}  // namespace aureole
