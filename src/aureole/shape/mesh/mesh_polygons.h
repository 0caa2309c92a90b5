// SPDX-License-Identifier: Apache-2.0
// Triangulates the polygons of mesh files.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/mesh_file.h"

namespace aureole {

/// A face of more than three corners, which a reader has stored as a fan: triangles (0, 1, 2), (0, 2, 3), ...
/// of its corners, beginning with the triangle `first`.
struct FannedPolygon {
  std::size_t first;
  std::size_t corners;
};

/// Triangulates the polygons whose fan is not a triangulation, by ear clipping (Meisters 1975) in the
/// coordinate plane in which the polygon's area is largest; all other polygons keep their fan. The number and
/// the orientation of the triangles do not change. Indices of positions must be in range. Returns notes on
/// polygons that intersect themselves, which have no triangulation. Throws Error for a polygon that takes too
/// long.
std::vector<std::string> triangulate_polygons(MeshData& data, std::span<const FannedPolygon> polygons,
                                              const MeshFile& file);

}  // namespace aureole
