// SPDX-License-Identifier: Apache-2.0
// Predicates on bounding boxes, which allow for rounding errors.
#pragma once

#include "aureole/math/vec.h"

namespace aureole {

/// Returns the box with a margin for rounding errors.
inline Bounds3 widened(const Bounds3& box) {
  const Vec3 margin = (abs(box.lower) + abs(box.upper)) * 1e-5f;
  return {box.lower - margin, box.upper + margin};
}

inline bool is_in(const Vec3& p, const Bounds3& box) {
  const Bounds3 wide = widened(box);
  for (int i = 0; i < 3; ++i)
    if (!(p[i] >= wide.lower[i] && p[i] <= wide.upper[i])) return false;
  return true;
}

inline bool overlap(const Bounds3& a, const Bounds3& b) {
  for (int i = 0; i < 3; ++i)
    if (!(a.lower[i] <= b.upper[i] && b.lower[i] <= a.upper[i])) return false;
  return true;
}

}  // namespace aureole
