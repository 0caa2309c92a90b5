// SPDX-License-Identifier: Apache-2.0
// `EdgeCovers`: which parts of an edge other faces cover, seen along the light.
//
// Faces that lie one behind another within a beam are one obstacle: its border is that of the union of their outlines. Of each edge
// that leaves what no face lies before or behind, since the border of a union is what of the borders lies in none of its parts. In
// clusters, which are flat and have many edges, only other shapes are looked for: that takes longer there than all else.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/scene/edge/edge_clusters.h"
#include "aureole/scene/edge/edge_index.h"
#include "aureole/scene/edge/face_tree.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// A part of an edge, as fractions of its length from its a.
struct EdgeStretch {
  double from = 0, to = 1;
};

class EdgeCovers {
public:
  EdgeCovers() = default;
  /// `depth`: how far before or behind an edge faces belong to the same obstacle, at most.
  EdgeCovers(const EdgeIndex& index, const EdgeClusters& clusters, FaceTree faces, float depth);

  /// Whether some face may cover part of the edge, from any direction for which that is an outline.
  bool may_be(std::size_t edge) const { return !begins_.empty() && begins_[edge] != begins_[edge + 1]; }
  /// The parts of an edge that no face covers in parallel light along d, in their order; they are the thread's, until the next call.
  std::span<const EdgeStretch> open(const MeshEdge& edge, std::size_t number, const Vec3& d,
                                    float depth) const;

private:
  using Triangle = FaceTree::Triangle;
  /// Edges with more faces near by than that look for them in the tree.
  static constexpr std::size_t kMostListed = 256;
  static constexpr std::uint32_t kMany = ~0u;

  std::vector<std::uint32_t>
      begins_;  ///< of each edge in `listed_`, and their end; empty where no edge is covered
  std::vector<std::uint32_t> listed_;  ///< numbers of faces, or kMany
  std::vector<Triangle> faces_;
  BeamTree tree_;  ///< of the faces, where one is needed
};

}  // namespace aureole
