// SPDX-License-Identifier: Apache-2.0
// Ray casting: the one place that calls Embree (what differs between Embree 3 and 4 is behind this file;
// shapes only make geometries).
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdint>
#include <span>

#include "aureole/shape/shape.h"

namespace aureole {

/// Embree takes coordinates up to this magnitude; an invalid ray makes builds of it that check their input,
/// as Debian's does, end the program.
inline constexpr float kFarthest = 1.8e18f;

/// False for a ray with NaN in it or beyond that range, which meets nothing.
inline bool is_traceable(const Ray& ray) {
  bool good = !std::isnan(ray.t_max);
  for (int i = 0; i < 3; ++i) good &= (std::abs(ray.o[i]) <= kFarthest) & (std::abs(ray.d[i]) <= kFarthest);
  return good;
}

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
  /// Builds the acceleration structure; throws Error where memory runs out.
  explicit RayTracer(std::span<const ShapePtr> shapes);
  ~RayTracer();
  RayTracer(const RayTracer&) = delete;
  RayTracer& operator=(const RayTracer&) = delete;

  struct Hit : ShapeHit {
    std::uint32_t shape = ~0u;  ///< index into the shapes; ~0 where nothing was met
    explicit operator bool() const { return shape != ~0u; }
  };
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
  static void load(const RayPacket& rays, int n, Rtc& r, int* valid);
  template <class Rtc, class Query>
  static void intersect_lanes(const RayPacket& rays, int n, Hit* hits, Query&& query);
  template <class Rtc, class Query>
  static void occluded_lanes(const RayPacket& rays, int n, bool* blocked, Query&& query);

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  Bounds3 bounds_;
};

}  // namespace aureole
