// SPDX-License-Identifier: Apache-2.0
// Points uniform over the whole surface of a shape.
#pragma once

#include <algorithm>
#include <vector>

#include "aureole/shape/shape.h"

namespace aureole {

class ShapeArea {
public:
  ShapeArea() = default;
  explicit ShapeArea(const Shape& shape) : shape_(&shape), below_{0} {
    for (std::size_t i = 0; i < shape.patch_count(); ++i)
      below_.push_back(below_.back() + double(shape.patch_area(i)));
  }

  double area() const { return below_.empty() ? 0 : below_.back(); }

  /// The patch is chosen by its area with u.x, what is left of u.x chooses the point.
  std::optional<ShapeSample> sample(Vec2 u) const {
    const double target = double(u.x) * area();
    const auto above = std::upper_bound(below_.begin() + 1, below_.end() - 1, target);
    const double first = *(above - 1), rest = (target - first) / (*above - first);
    const auto patch = std::size_t(above - below_.begin() - 1);
    return shape_->sample_area(patch, {float(std::clamp(rest, 0.0, 0x1.fffffep-1)), u.y});
  }

private:
  const Shape* shape_ = nullptr;
  std::vector<double> below_;  ///< area of all patches before each one; the last is the sum
};

}  // namespace aureole
