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
  std::vector<std::uint32_t> set_of;  ///< of each face
  BeamTree tree;                      ///< of their boxes
};

/// How many faces cut through others or are cut by them, without a common corner: none that only touch, or that lie in one plane. Of those
/// that meet the boxes of many others perhaps not all are found.
std::size_t count_crossing_faces(const FaceTree& faces);

/// A remark where some do; empty: none do.
std::string remark_on_crossings(const FaceTree& faces);

}  // namespace aureole
