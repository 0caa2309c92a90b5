// SPDX-License-Identifier: Apache-2.0
// The triangles of all diffracting shapes, in one tree.
#pragma once

#include <array>
#include <string>

#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/mesh_edges.h"

namespace aureole {

struct FaceTree {
  using Triangle = std::array<Vec3, 3>;

  FaceTree() = default;
  explicit FaceTree(std::span<const TriangleSet> sets);

  std::vector<Triangle> faces;
  std::vector<std::uint32_t> set_of;  ///< set of each face
  BeamTree tree;                      ///< tree of the faces' boxes
};

/// Returns the number of faces that cut through others or are cut by them, without a common corner. Faces
/// that only touch, or lie in one plane, do not count. Faces whose boxes overlap those of very many others
/// may be missed.
std::size_t count_crossing_faces(const FaceTree& faces);

/// Returns a note on crossing faces; empty if there are none.
std::string remark_on_crossings(const FaceTree& faces);

}  // namespace aureole
