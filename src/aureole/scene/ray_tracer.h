// SPDX-License-Identifier: Apache-2.0
// Ray casting. Only this file calls Embree to trace rays and hides the differences between Embree 3 and 4;
// shapes only create geometries.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "aureole/asset/primitive.h"

namespace aureole {

/// Largest magnitude of a coordinate that Embree accepts. Builds of Embree that check their input, such as
/// Debian's, terminate the program on an invalid ray.
inline constexpr float kFarthest = 1.8e18f;
static_assert(2 * kFarthestPlace <= double(kFarthest));

/// A packet of up to 16 rays that the ray tracer traces together.
class RayPacket {
public:
  static constexpr int kSize = 16;
  void set(int lane, const Ray& ray) {
    for (int i = 0; i < 3; ++i) o_[i][lane] = ray.o[i], d_[i][lane] = ray.d[i];
    t_max_[lane] = ray.t_max, time_[lane] = ray.time;
  }
  Ray get(int lane) const {
    return {{o_[0][lane], o_[1][lane], o_[2][lane]},
            {d_[0][lane], d_[1][lane], d_[2][lane]},
            t_max_[lane],
            time_[lane]};
  }

private:
  friend class RayTracer;
  alignas(64) float o_[3][kSize] = {}, d_[3][kSize] = {}, t_max_[kSize] = {}, time_[kSize] = {};
};

class RayTracer {
public:
  /// Builds the acceleration structure. It reuses the device, the geometries of equal shapes and the
  /// structures of equal groups of another tracer, which may be in use meanwhile. Throws Error if memory runs
  /// out.
  explicit RayTracer(std::span<const Primitive> parts, const RayTracer* reuse = nullptr);
  RayTracer(const RayTracer&) = delete;
  RayTracer& operator=(const RayTracer&) = delete;

  /// Whether the tracer was built for these parts: equal shapes, and instances of equal shapes with equal
  /// transforms.
  bool is_for(std::span<const Primitive> parts) const;

  struct Hit : ShapeHit {
    std::uint32_t shape = ~0u;  ///< index of the hit shape; ~0 if the ray hit nothing
    explicit operator bool() const { return shape != ~0u; }
    /// Whether the ray hit nothing because it could not be traced.
    bool is_lost() const { return shape == ~0u && geometry == kLost; }
    static constexpr std::uint32_t kLost = ~0u;
  };
  /// Largest coordinate of ray origins and directions that can be traced: kFarthest, or less if an instance
  /// magnifies coordinates.
  float farthest() const { return farthest_; }
  /// Whether a ray can be traced: false for a ray that contains NaN or exceeds `farthest`. `intersect`
  /// reports such a ray as lost, `occluded` as occluded.
  bool is_traceable(const Ray& ray) const {
    bool good = !std::isnan(ray.t_max);
    for (int i = 0; i < 3; ++i) good &= (std::abs(ray.o[i]) <= farthest_) & (std::abs(ray.d[i]) <= farthest_);
    return good;
  }
  Hit intersect(const Ray& ray) const;
  /// Replaces `hits` by all hits of the ray beyond the distance t_min, in order of distance. A ray through an edge
  /// between two triangles may hit both. Rays that cannot be traced have no hits.
  void all_hits(const Ray& ray, float t_min, std::vector<Hit>& hits) const;
  bool occluded(const Ray& ray) const;

  /// Traces the first n rays of a packet at once. Results are bitwise equal to tracing the rays one by one,
  /// except on curves. There the hit on a spline may differ in the last bits, and a hit in the ball that
  /// joins two segments may be reported on either (tests/integrator/packet_test.cpp).
  enum class Rays { coherent, incoherent };
  void intersect(const RayPacket& rays, int n, Rays kind, Hit* hits) const;
  void occluded(const RayPacket& rays, int n, bool* blocked) const;
  Bounds3 bounds() const { return bounds_; }

private:
  void load_ray(const Ray& ray, RTCRay& r) const;
  template <class Rtc>
  void load(const RayPacket& rays, int n, Rtc& r, int* valid) const;
  template <class Rtc, class Query>
  void intersect_lanes(const RayPacket& rays, int n, Hit* hits, Query&& query) const;
  template <class Rtc, class Query>
  void occluded_lanes(const RayPacket& rays, int n, bool* blocked, Query&& query) const;

  /// A shape or an instance in the scene.
  struct Item {
    ShapePtr shape;
    std::shared_ptr<const Instance> instance;
  };
  // Embree counts references to its geometry, but not to the shape that owns the geometry's buffers: `shape`
  // must outlive `handle`.
  struct Geometry {
    ShapePtr shape;
    std::shared_ptr<RTCGeometryTy> handle;
  };
  /// The acceleration structure of a group's shapes.
  struct Group {
    std::vector<std::shared_ptr<const Geometry>> members;
    std::shared_ptr<RTCSceneTy> handle;
  };

  std::shared_ptr<const Geometry> geometry_of(const ShapePtr& shape, const RayTracer* reuse);
  const Group& group_of(const ShapeList& list, const RayTracer* reuse);
  std::shared_ptr<RTCSceneTy> new_scene() const;

  std::vector<Item> items_;
  std::shared_ptr<RTCDeviceTy> device_;
  std::unordered_map<const Shape*, std::shared_ptr<const Geometry>> geometries_;
  std::vector<std::shared_ptr<const Group>> groups_;
  std::shared_ptr<RTCSceneTy> owned_scene_;
  RTCScene scene_ = nullptr;  ///< handle of `owned_scene_`, without the smart pointer
  Bounds3 bounds_;
  float farthest_ = kFarthest;
  TimeWindow window_;  ///< of instances that move
};

}  // namespace aureole
