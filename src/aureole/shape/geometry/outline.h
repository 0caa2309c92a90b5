// SPDX-License-Identifier: Apache-2.0
// Triangle meshes that approximate round shapes, for algorithms that need edges: the rims and outlines that
// diffract light.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/mesh/mesh_patches.h"

namespace aureole {

struct OutlineMesh {
  std::vector<Vec3> positions;
  std::vector<TriangleIndices> triangles;

  std::uint32_t add(const Double3& p) {
    positions.push_back(p.to_float());
    return std::uint32_t(positions.size() - 1);
  }
};

/// An interface that round shapes implement besides `Shape`, found by dynamic_cast.
class RoundShape {
public:
  virtual ~RoundShape() = default;

  /// Largest radius, of curvature or of a rim, in the shape's local coordinates.
  virtual double round_radius() const = 0;
  /// Whether the surface curves away behind its outline; false for a flat disc.
  virtual bool is_curved() const = 0;
  /// Whether it is visible from inside, as the walls of a room.
  virtual bool is_hollow() const { return false; }
  /// Returns triangles with `pieces` sides around the shape. Their edges lie on the shape or outside by at
  /// most 12/pieces^2 of the radius.
  virtual OutlineMesh outline_mesh(int pieces) const = 0;
  /// Returns the approximate number of edges of that mesh.
  virtual double edge_count(int pieces) const = 0;
};

/// Corners of a regular polygon circumscribed about the unit circle.
inline std::vector<Double3> polygon_around_circle(int pieces) {
  std::vector<Double3> corners;
  const double step = 2 * 3.14159265358979323846 / pieces, r = 1 / std::cos(0.5 * step);
  for (int i = 0; i < pieces; ++i) corners.push_back({r * std::cos(i * step), r * std::sin(i * step), 0});
  return corners;
}

}  // namespace aureole
