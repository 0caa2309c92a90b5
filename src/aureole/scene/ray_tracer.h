// SPDX-License-Identifier: Apache-2.0
// Ray casting: the one place that calls Embree (what differs between Embree 3 and 4 is behind this file;
// shapes only make geometries).
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

/// Embree takes coordinates up to this magnitude; an invalid ray makes builds of it that check their input,
/// as Debian's does, end the program.
inline constexpr float kFarthest = 1.8e18f;
static_assert(2 * kFarthestPlace <= double(kFarthest));

/// Up to 16 rays that are traced together.
class RayPacket {
public:
  static constexpr int kSize = 16;
  void set(int lane, const Ray& ray) {
    for (int i = 0; i < 3; ++i) o_[i][lane] = ray.o[i], d_[i][lane] = ray.d[i];
    t_max_[lane] = ray.t_max;
  }
  Ray get(int lane) const {
    return {{o_[0][lane], o_[1][lane], o_[2][lane]}, {d_[0][lane], d_[1][lane], d_[2][lane]}, t_max_[lane]};
  }

private:
  friend class RayTracer;
  alignas(64) float o_[3][kSize] = {}, d_[3][kSize] = {}, t_max_[kSize] = {};
};

class RayTracer {
public:
  /// Builds the acceleration structure. Reuses the device, geometries of equal shapes and structures of equal
  /// groups of another tracer, which may be tracing meanwhile. Throws Error where memory runs out.
  explicit RayTracer(std::span<const Primitive> parts, const RayTracer* reuse = nullptr);
  RayTracer(const RayTracer&) = delete;
  RayTracer& operator=(const RayTracer&) = delete;

  /// Whether it was built for these parts: the same shapes, and instances of the same shapes with the same
  /// transforms.
  bool is_for(std::span<const Primitive> parts) const;

  struct Hit : ShapeHit {
    std::uint32_t shape = ~0u;  ///< index into the shapes; ~0 where nothing was met
    explicit operator bool() const { return shape != ~0u; }
    /// Nothing was met because the ray could not be traced.
    bool is_lost() const { return shape == ~0u && geometry == kLost; }
    static constexpr std::uint32_t kLost = ~0u;
  };
  /// Coordinates of origins and directions up to this magnitude can be traced: kFarthest, or less where an
  /// instance magnifies them.
  float farthest() const { return farthest_; }
  /// False for a ray with NaN in it or beyond that range: it is lost, and blocked where it is tested.
  bool is_traceable(const Ray& ray) const {
    bool good = !std::isnan(ray.t_max);
    for (int i = 0; i < 3; ++i) good &= (std::abs(ray.o[i]) <= farthest_) & (std::abs(ray.d[i]) <= farthest_);
    return good;
  }
  Hit intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  /// The first n rays of a packet at once. The answers are the same as one by one, bit for bit, but on
  /// curves: splines by the last bits, and which of two segments was met in the ball that they share
  /// (tests/integrator/packet_test.cpp).
  enum class Rays { coherent, incoherent };
  void intersect(const RayPacket& rays, int n, Rays kind, Hit* hits) const;
  void occluded(const RayPacket& rays, int n, bool* blocked) const;
  Bounds3 bounds() const { return bounds_; }

private:
  template <class Rtc>
  void load(const RayPacket& rays, int n, Rtc& r, int* valid) const;
  template <class Rtc, class Query>
  void intersect_lanes(const RayPacket& rays, int n, Hit* hits, Query&& query) const;
  template <class Rtc, class Query>
  void occluded_lanes(const RayPacket& rays, int n, bool* blocked, Query&& query) const;

  /// A shape or an instance of the scene.
  struct Item {
    ShapePtr shape;
    std::shared_ptr<const Instance> instance;
  };
  // Embree counts references to its geometry, but not to the shape whose buffers the geometry uses: `shape`
  // must outlive `handle`.
  struct Geometry {
    ShapePtr shape;
    std::shared_ptr<RTCGeometryTy> handle;
  };
  /// The structure of a group's shapes.
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
  RTCScene scene_ = nullptr;  ///< `owned_scene_`, or a scene of another owner
  Bounds3 bounds_;
  float farthest_ = kFarthest;
};

}  // namespace aureole
