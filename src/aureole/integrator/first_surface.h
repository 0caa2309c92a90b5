// SPDX-License-Identifier: Apache-2.0
// The first surface that ends a ray of `dvr`, `splat` or `radiance_field`: the ray crosses null surfaces, which bound media.
#pragma once

#include <span>

#include "aureole/transport/batch.h"

namespace aureole {

/// The first surface along a ray that is not null.
struct FirstSurface {
  float distance = kInfinity;  ///< along the ray to just before the surface; infinity: there is none
  /// A point on the surface's near side, off the surface by more than the rounding of its coordinates: a ray from there in the direction of the
  /// given one hits the surface, at any angle.
  Vec3 before;

  /// Moves the beginning of the ray forward: to the distance `from`, or to `before` where that is nearer or as near to rounding.
  void move_beginning(Ray& ray, float from) const {
    constexpr float kRounding = 1e-5f;
    const bool is_before = from < distance * (1 - kRounding);
    ray.o = is_before ? ray.o + ray.d * from : before;
    ray.t_max -= is_before ? from : distance;
  }
};

/// Finds the first surface of each ray that is not null and lies before its t_max. The rays have unit
/// directions.
void find_first_surfaces(const Scene& scene, std::span<const Ray> rays, RayTracer::Rays kind,
                         FirstSurface found[]);

}  // namespace aureole
