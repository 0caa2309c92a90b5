// SPDX-License-Identifier: Apache-2.0
// The edges of triangle meshes at which light can be diffracted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/shape/mesh/mesh_patches.h"

namespace aureole {

/// Triangles in the world.
struct TriangleSet {
  std::span<const Vec3> positions;
  std::span<const TriangleIndices> triangles;
};

/// A triangle of one of several sets.
struct MeshFace {
  std::uint32_t set, triangle;
};

/// An edge that bounds the outline of its surface, seen from at least one direction: the boundary of a
/// surface, or a fold.
struct MeshEdge {
  Vec3 a, b;    ///< the first face lies to the left, seen from the side of n0
  Vec3 n0, n1;  ///< unit normals of the faces, on one side of the surface; n1 is 0 at a boundary
  MeshFace face0, face1;
  bool is_boundary;  ///< of one face, or of several that lie in one half-plane about the edge
  bool is_concave;   ///< a fold towards the side of its normals
  /// Number of the leg of a path between planar mirrors that the edge lies beside (transport/edge_unfolding.h).
  std::uint8_t leg = 0;

  /// Whether, in parallel light along `d`, one face is irradiated from the front and the other from the back.
  bool is_outline(const Vec3& d) const { return is_boundary | (dot(n0, d) * dot(n1, d) <= 0); }
  /// Returns a unit direction of light for which the edge is an outline.
  Vec3 across() const {
    const Vec3 d = is_boundary ? n0 : cross(b - a, n0 + n1);
    return normalize(length_squared(d) > 0 ? d : n0);
  }
  float squared_distance(const Vec3& p) const {
    const Vec3 way = b - a, to = p - a;
    return length_squared(to - way * std::clamp(dot(to, way) / length_squared(way), 0.f, 1.f));
  }
};

/// Returns the edges of all sets together. Vertices at one position are one vertex: seams of texture
/// coordinates or normals, and borders between meshes that touch, are no edges. Folds of less than 1e-4 rad,
/// edges or triangles without extent, and edges with faces on both sides from every direction are no edges
/// either, nor is the part of a surface's border that lies on another surface in its plane. If more than two
/// faces share an edge, the outermost two count.
std::vector<MeshEdge> find_mesh_edges(std::span<const TriangleSet> sets);

}  // namespace aureole
