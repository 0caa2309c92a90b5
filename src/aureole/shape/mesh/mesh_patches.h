// SPDX-License-Identifier: Apache-2.0
// The patches by which a mesh is sampled as an area emitter: triangles, and parallelograms of two triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

using TriangleIndices = std::array<std::uint32_t, 3>;
using TriangleCorners = std::array<Vec3, 3>;

/// One triangle, or two that form a parallelogram. Corner `apex[i]` of triangle i is opposite the shared
/// edge.
struct MeshPatch {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t triangle[2] = {0, kNone};
  std::uint8_t apex[2] = {0, 0};
  bool is_rectangle = false;
  // Values that are precomputed to choose the sampling technique quickly:
  float area = 0;
  float longest_squared = 0;  ///< longest edge of the first triangle
  Vec3 center;                ///< centroid of the first triangle
  // Points of the patch are origin + x along_x + y along_y, with x + y <= 1 in a single triangle.
  Vec3 origin;            ///< corner apex[0] of the first triangle
  Vec3 along_x, along_y;  ///< vectors to the two neighbouring corners
  Vec3 ng;                ///< normal of the first triangle, unit length
  float error = 0;        ///< upper bound of the distance of these points from the surface, along ng

  Vec3 point(Vec2 at) const { return origin + along_x * at.x + along_y * at.y; }
  bool is_pair() const { return triangle[1] != kNone; }
  /// Computes all members that follow from the triangles.
  void measure(std::span<const Vec3> positions, std::span<const TriangleIndices> triangles);
};

struct MeshPatches {
  std::vector<MeshPatch> patches;
  std::vector<std::uint32_t> of_triangle;  ///< index of the patch that contains each triangle

  bool empty() const { return patches.empty(); }
  /// Pairs triangles that share an edge and form a parallelogram to within rounding. A pair is better than
  /// two triangles: light selection has half as many patches, and a rectangle is sampled without first
  /// choosing a triangle.
  static MeshPatches build(std::span<const Vec3> positions, std::span<const TriangleIndices> triangles);
};

}  // namespace aureole
