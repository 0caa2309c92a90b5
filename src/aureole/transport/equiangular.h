// SPDX-License-Identifier: Apache-2.0
// Equiangular sampling (Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in
// participating media", section 4): positions along a segment with a density in proportion to the inverse
// square of their distance from a point.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/math/vec.h"

namespace aureole {

class Equiangular {
public:
  /// Samples along `ray`, of unit direction, up to the distance t_max, about `pivot`. Distances to the pivot
  /// below `radius` count as `radius`.
  Equiangular(const Ray& ray, float t_max, const Vec3& pivot, float radius) {
    const Vec3 to = pivot - ray.o;
    nearest_ = dot(to, ray.d);
    distance_ = std::max(length(cross(to, ray.d)), radius);
    begin_ = std::atan(-nearest_ / distance_);
    angle_ = std::atan((t_max - nearest_) / distance_) - begin_;
    t_max_ = t_max;
  }

  /// False where rounding leaves no interval to sample.
  bool is_valid() const { return angle_ > 1e-5f && distance_ > 0; }
  float sample(float u) const {
    return std::clamp(nearest_ + distance_ * std::tan(begin_ + u * angle_), 0.f, t_max_);
  }
  float pdf(float t) const {
    const float along = t - nearest_;
    return distance_ / (angle_ * (distance_ * distance_ + along * along));
  }
  float distance() const { return distance_; }
  /// Distance along the ray to the position nearest to the pivot.
  float nearest() const { return std::clamp(nearest_, 0.f, t_max_); }

private:
  float nearest_, distance_, begin_, angle_, t_max_;
};

}  // namespace aureole
