// SPDX-License-Identifier: Apache-2.0
// `EdgeCovers`: which parts of an edge are covered by other faces, seen along the light.
//
// Faces that lie one behind another within a beam are one obstacle, whose border is that of the union of
// their outlines. A part of an edge belongs to that border if no face lies before or behind it. Clusters are
// flat and have many edges: for their edges only other shapes are searched, since testing their own faces
// would dominate the time.
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

/// A part of an edge, as fractions of its length from its vertex a.
struct EdgeStretch {
  double from = 0, to = 1;
};

class EdgeCovers {
public:
  EdgeCovers() = default;
  /// `depth` is the largest distance along the light at which faces before or behind an edge belong to the
  /// same obstacle.
  EdgeCovers(const EdgeIndex& index, const EdgeClusters& clusters, FaceTree faces, float depth);

  /// Returns whether some face may cover part of the edge, from any direction for which the edge is an
  /// outline.
  bool may_be(std::size_t edge) const { return !begins_.empty() && begins_[edge] != begins_[edge + 1]; }
  /// Returns the parts of an edge that no face covers in parallel light along d, in ascending order. They
  /// belong to the calling thread and are valid until its next call.
  std::span<const EdgeStretch> open(const MeshEdge& edge, std::size_t number, const Vec3& d,
                                    float depth) const;

private:
  using Triangle = FaceTree::Triangle;
  /// Edges with more nearby faces search for them in the tree.
  static constexpr std::size_t kMostListed = 256;
  static constexpr std::uint32_t kMany = ~0u;

  std::vector<std::uint32_t>
      begins_;  ///< first index in `listed_` for each edge, and the end; empty if no edge is covered
  std::vector<std::uint32_t> listed_;  ///< numbers of faces, or kMany
  std::vector<Triangle> faces_;
  BeamTree tree_;  ///< tree of the faces, if an edge has kMany
};

}  // namespace aureole
