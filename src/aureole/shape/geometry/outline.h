// SPDX-License-Identifier: Apache-2.0
// Triangle meshes that approximate round shapes, for algorithms that need edges: the rims and outlines that
// diffract light.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/geometry/shape_placement.h"
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
  /// The centre of a ball in local coordinates; empty for other shapes.
  virtual std::optional<Double3> ball_center() const { return std::nullopt; }
  /// Whether the shape ends at circles, as a disc or a cylinder does.
  virtual bool has_rims() const { return false; }
  /// Whether the shape is visible from inside, like the walls of a room.
  virtual bool is_hollow() const { return false; }
  /// Returns triangles with `pieces` sides around the shape. Their edges lie on the shape or outside by at
  /// most 12/pieces^2 of the radius.
  virtual OutlineMesh outline_mesh(int pieces) const = 0;
  /// Returns the approximate number of edges of `outline_mesh`.
  virtual double edge_count(int pieces) const = 0;
};

/// Corners of a regular polygon circumscribed about the unit circle of the local xy plane. If it is a circle
/// in the world as well, the first corner lies in a direction that depends on the circle's axis alone, so
/// that a disc that closes a cylinder has the same corners as the cylinder's rim. `pieces` is a
/// multiple of 4.
inline std::vector<Double3> polygon_around_circle(int pieces, const Placement& place) {
  const Double3 &x = place.axis(0), &y = place.axis(1);
  double begin = 0;
  if (const double a = length(x), b = length(y);
      std::abs(a - b) < 1e-5 * a && std::abs(dot(x, y)) < 1e-5 * a * b) {
    const Double3 axis = cross(x, y) * (1 / (a * b));
    const double least = std::min({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
    Double3 across{0, 0, 1};
    if (std::abs(axis.x) <= least + 1e-6)
      across = {1, 0, 0};
    else if (std::abs(axis.y) <= least + 1e-6)
      across = {0, 1, 0};
    begin = std::atan2(dot(across, y), dot(across, x));
  }
  std::vector<Double3> corners;
  const double step = 2 * std::numbers::pi / pieces, r = 1 / std::cos(0.5 * step);
  for (int i = 0; i < pieces; ++i)
    corners.push_back({r * std::cos(begin + i * step), r * std::sin(begin + i * step), 0});
  return corners;
}

}  // namespace aureole
