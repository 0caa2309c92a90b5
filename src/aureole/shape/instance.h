// SPDX-License-Identifier: Apache-2.0
// An instance of a group of shapes in the scene.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "aureole/math/motion.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

class Properties;
class Shape;
struct ShapeList;

/// The time from the first exposure of a sensor to the last one, in which shapes move.
struct TimeWindow {
  bool is_open = false;  ///< false: nothing moves
  float start = 0;       ///< [s]
  float scale = 0;       ///< inverse of its length [1/s]; 0 for an instant
  /// The time as a fraction of the window, as the ray tracer counts it.
  float fraction(float time) const {
    return is_open ? std::min(std::max((time - start) * scale, 0.f), 1.f) : 0.f;
  }
};

class Instance {
public:
  /// `list` (asset/primitive.h) has the shapes, which lie in `bounds`, and `to_outer` maps them to the coordinates that
  /// `motion` moves; errors are located at `to_world` of `properties`. An instance that moves stands at its first key
  /// frame until `during` sets it in motion.
  Instance(std::shared_ptr<const ShapeList> list, const Bounds3& bounds, const Motion& motion,
           const Transform& to_outer, const Properties& properties);

  const ShapeList& list() const { return *list_; }
  /// Whether the other one has equal transforms, at all times.
  bool is_in_same_place(const Instance& other) const;

  bool is_moving() const { return path_ != nullptr; }
  /// The instance as it moves between two times [s]. Its transform is linear between up to 129 equidistant times, by
  /// which the ray tracer interpolates.
  std::shared_ptr<const Instance> during(double open, double close) const;
  const TimeWindow& window() const { return path_->window; }
  /// Largest distance of a corner of the bounds from its exact place at times between these, in scene units.
  double deviation() const { return path_->deviation; }

  /// Returns a committed Embree geometry, owned by the caller; `scene` contains the shapes.
  RTCGeometry make_geometry(RTCDevice device, RTCScene scene) const;
  /// Returns the surface point of a hit on `shape`, one of the group's. Sets all members except `surface`.
  SurfacePoint surface_point(const Shape& shape, const ShapeHit& hit, const Ray& ray, bool tangent) const;
  Vec3 point_to_world(const Vec3& p) const;
  Vec3 point_to_group(const Vec3& p) const { return point_to_group(p, maps_); }
  /// Returns the point at a time [s].
  Vec3 point_to_group(const Vec3& p, float time) const {
    return path_ ? point_to_group(p, maps_at(time)) : point_to_group(p, maps_);
  }
  /// Returns the transforms with which rays and points are transformed, rounded to single precision; of an instance that
  /// moves those at its first key frame.
  Transform to_world() const { return affine(maps_.to_world); }
  Transform to_group() const { return affine(maps_.to_group); }
  /// Returns the transform of points at a time [s].
  Transform to_world_at(float time) const { return affine(path_ ? maps_at(time).to_world : maps_.to_world); }
  SurfaceDerivatives to_world(const SurfaceDerivatives& d, float time) const;
  Bounds3 bounds() const;
  /// Returns the magnitude of origins and directions of rays up to which their transformed coordinates are at
  /// most `limit`.
  float farthest(float limit) const;

private:
  /// Rows of the matrix of an affine map.
  using Rows = std::array<std::array<float, 4>, 3>;
  /// The transforms in single precision, as the ray caster stores them: the rounded transform defines the instance's
  /// position.
  struct Maps {
    Rows to_world, to_group;
    Rows error;  ///< bound of the ray caster's error for an origin o: `error` applied to (|o|, 1)
  };
  /// An instance in motion.
  struct Path {
    Motion motion;
    Transform to_outer;
    TimeWindow window;
    std::vector<Rows> steps;  ///< to_world at equidistant times of the window
    double deviation = 0;
  };

  static Transform affine(const Rows& rows);
  static Rows rounded(const Transform& transform);
  /// Sets the inverse of `to_world` and its error. Returns false where it leaves the range of single precision.
  static bool invert(Maps& maps);
  static Vec3 point_to_group(const Vec3& p, const Maps& maps);
  static float farthest(float limit, const Maps& maps);
  Bounds3 bounds_by(const Rows& to_world) const;
  Maps maps_at(float time) const;
  SurfacePoint surface_point(const Shape& shape, const ShapeHit& hit, const Ray& ray, bool tangent,
                             const Maps& maps) const;

  std::shared_ptr<const ShapeList> list_;
  Bounds3 bounds_;  ///< of the shapes, in the group's coordinates
  Maps maps_;
  std::shared_ptr<const Path> path_;  ///< null for an instance at rest
};

}  // namespace aureole
