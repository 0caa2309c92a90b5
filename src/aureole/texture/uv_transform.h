// SPDX-License-Identifier: Apache-2.0
// The two rows of a `to_uv` transform that apply to texture coordinates, in single precision for the inner
// loop.
#pragma once

#include "aureole/math/transform.h"

namespace aureole {

class UvTransform {
public:
  explicit UvTransform(const Transform& t) {
    const Vec2 origin = t.point2({0, 0}), u = t.point2({1, 0}), v = t.point2({0, 1});
    offset_ = origin;
    du_ = u - origin;
    dv_ = v - origin;
  }
  Vec2 operator()(Vec2 uv) const {
    return {du_.x * uv.x + dv_.x * uv.y + offset_.x, du_.y * uv.x + dv_.y * uv.y + offset_.y};
  }
  /// Returns the gradient by uv of a function whose gradient by the transformed coordinates is `g`.
  Vec2 gradient(Vec2 g) const { return {dot(du_, g), dot(dv_, g)}; }

private:
  Vec2 du_, dv_, offset_;
};

}  // namespace aureole
