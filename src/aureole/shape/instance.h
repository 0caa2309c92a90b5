// SPDX-License-Identifier: Apache-2.0
// An instance of a group of shapes in the scene.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <memory>

#include "aureole/math/transform.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

class Properties;
class Shape;
struct ShapeList;

class Instance {
public:
  /// Makes an instance. `list` (asset/primitive.h) has the shapes, which lie in `bounds`; errors are located
  /// at `to_world` of `properties`.
  Instance(std::shared_ptr<const ShapeList> list, const Bounds3& bounds, const Transform& to_world,
           const Properties& properties);

  const ShapeList& list() const { return *list_; }
  bool is_in_same_place(const Instance& other) const { return to_world_ == other.to_world_; }

  /// Returns a committed Embree geometry, owned by the caller; `scene` contains the shapes.
  RTCGeometry make_geometry(RTCDevice device, RTCScene scene) const;
  /// Returns the surface point of a hit on `shape`, one of the group's. Sets all members except `surface`.
  SurfacePoint surface_point(const Shape& shape, const ShapeHit& hit, const Ray& ray, bool tangent) const;
  Vec3 point_to_world(const Vec3& p) const;
  Vec3 point_to_group(const Vec3& p) const;
  /// Returns the transforms with which rays and points are transformed, rounded to single precision.
  Transform to_world() const { return affine(to_world_); }
  Transform to_group() const { return affine(to_group_); }
  SurfaceDerivatives to_world(const SurfaceDerivatives& d) const;
  Bounds3 bounds() const;
  /// Returns the magnitude of origins and directions of rays up to which their transformed coordinates are at
  /// most `limit`.
  float farthest(float limit) const;

private:
  /// Rows of the matrix of an affine map.
  using Rows = std::array<std::array<float, 4>, 3>;
  static Transform affine(const Rows& rows);

  std::shared_ptr<const ShapeList> list_;
  Bounds3 bounds_;  ///< bounds of the shapes, in the group's coordinates
  // The transforms in single precision, as the ray caster stores them: the rounded transform defines the
  // instance's position.
  Rows to_world_, to_group_;
  Rows error_;  ///< bound of the ray caster's error for an origin o: error_ applied to (|o|, 1)
};

}  // namespace aureole
