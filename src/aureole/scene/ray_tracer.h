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

  /// Up to 16 rays at once. The answers are the same as one by one, bit for bit, but on curves: splines by
  /// the last bits, and which of two segments was met in the ball that they share
  /// (tests/integrator/packet_test.cpp).
  static constexpr int kPacket = 16;
  enum class Rays { coherent, incoherent };
  void intersect(const Ray* rays, int n, Rays kind, Hit* hits) const;
  void occluded(const Ray* rays, int n, bool* blocked) const;
  Bounds3 bounds() const { return bounds_; }

private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  Bounds3 bounds_;
};

}  // namespace aureole
