// SPDX-License-Identifier: Apache-2.0
// Instancing: a group of shapes with an acceleration structure of its own, which stands in the scene many
// times.
#pragma once

#include "aureole/shape/unsampled_shape.h"

namespace aureole {

/// Shapes in coordinates of their own. Not rendered; what is nested (groups, instances, shapes of several
/// parts) is taken apart, because Embree is built for one level of instances.
class ShapeGroup final : public UnsampledShape {
public:
  /// Another group that belongs to this one.
  struct Nested {
    std::shared_ptr<const ShapeGroup> group;
    Transform to_group;
  };

  explicit ShapeGroup(const Properties& properties);
  ~ShapeGroup() override;

  const std::vector<ShapePtr>& shapes() const { return shapes_; }
  const std::vector<Nested>& nested() const { return nested_; }
  /// The Embree scene of `shapes`, built when it is first asked for and shared by all instances on a device.
  RTCScene embree_scene(RTCDevice device) const;
  /// Counts the instances, each of which has a share in the group's memory.
  void add_instance() const { ++instances_; }
  std::size_t instances() const { return instances_; }

  const std::vector<ShapePtr>* parts() const override { return &nothing_; }
  bool is_passable() const override { return passable_; }
  Bounds3 bounds() const override { return bounds_; }
  std::size_t primitive_count() const override;
  std::size_t memory_bytes() const override;
  RTCGeometry make_geometry(RTCDevice device) const override;
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray) const override {
    return shapes_[hit.geometry]->surface_point(hit, ray);
  }

private:
  SurfaceDerivatives own_derivatives(const SurfacePoint&) const override { return {}; }
  void add(const ShapePtr& shape);
  void release() const;

  std::vector<ShapePtr> shapes_, nothing_;
  std::vector<Nested> nested_;
  Bounds3 bounds_;
  bool passable_ = false;
  mutable RTCDevice device_ = nullptr;  ///< of scene_
  mutable RTCScene scene_ = nullptr;
  mutable std::size_t instances_ = 0;
};

/// A group of shapes in one place of the scene.
class Instance final : public UnsampledShape {
public:
  explicit Instance(const Properties& properties);
  /// Of the shapes of `group` itself, without what is nested there.
  Instance(const Properties& properties, std::shared_ptr<const ShapeGroup> group, const Transform& to_world);

  const std::shared_ptr<const ShapeGroup>& group() const { return group_; }

  const std::vector<ShapePtr>* parts() const override { return is_one_ ? nullptr : &parts_; }
  bool is_passable() const override { return group_->is_passable(); }
  Bounds3 bounds() const override;
  std::size_t primitive_count() const override { return group_->primitive_count(); }
  std::size_t memory_bytes() const override;
  RTCGeometry make_geometry(RTCDevice device) const override;
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray) const override;

private:
  /// Rows of an affine map.
  using Rows = std::array<std::array<float, 4>, 3>;

  SurfaceDerivatives own_derivatives(const SurfacePoint&) const override { return {}; }
  SurfaceDerivatives instance_to_world(const SurfaceDerivatives& d) const override;
  /// Adds an instance of the group's own shapes and of every group nested in it to `parts_`.
  void take_apart(const std::shared_ptr<const ShapeGroup>& group, const Transform& to_world);
  void place(const Transform& to_world);

  std::shared_ptr<const ShapeGroup> group_;
  std::vector<ShapePtr> parts_;  ///< where the group holds others
  bool is_one_ = true;
  // In single precision, as the ray caster has it: what is rounded is where the instance stands.
  Rows to_world_, to_group_;
  Rows error_;  ///< bound of the ray caster's error for an origin o: error_ applied to (|o|, 1)
};

}  // namespace aureole
