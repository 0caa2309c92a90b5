// SPDX-License-Identifier: Apache-2.0
// A shape that is no light source: it has no patches.
#pragma once

#include "aureole/shape/shape.h"

namespace aureole {

class UnsampledShape : public Shape {
public:
  std::size_t patch_count() const final { return 0; }
  std::size_t patch_of_primitive(std::uint32_t) const final { return 0; }
  float patch_area(std::size_t) const final { return 0; }
  Bounds3 patch_bounds(std::size_t) const final { return {}; }
  std::pair<Vec3, float> patch_normals(std::size_t) const final { return {{0, 0, 1}, -1.f}; }
  std::optional<ShapeSample> sample_direct(const Vec3&, std::size_t, Vec2) const final { return {}; }
  std::optional<ShapeSample> sample_area(std::size_t, Vec2) const final { return {}; }
  float pdf_direct(const Vec3&, std::size_t, const SurfacePoint&) const final { return 0; }

protected:
  using Shape::Shape;
};

}  // namespace aureole
