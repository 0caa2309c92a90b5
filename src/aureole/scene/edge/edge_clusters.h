// SPDX-License-Identifier: Apache-2.0
// Groups of edges that all lie within one beam and apart from all others, such as those of a small hole: their waves are summed at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {

class EdgeClusters {
public:
  EdgeClusters() = default;
  /// Edges that lie within `coherent` of one another belong together, by way of others, too, by their boxes. A cluster has at least
  /// kFewest of them, is no longer than twice that distance and is flat, so that no edge lies behind another one; no edge outside it
  /// lies within the distance of one inside.
  EdgeClusters(const EdgeIndex& index, float coherent);

  /// The pairs of fewer edges cost little, and drawn wave vectors have noise of their own.
  static constexpr std::size_t kFewest = 16;

  /// The numbers of the edges in the cluster of an edge; empty where it belongs to none.
  std::span<const std::uint32_t> of(std::size_t edge) const {
    if (cluster_of_.empty() || cluster_of_[edge] == kNone) return {};
    const std::uint32_t c = cluster_of_[edge];
    return std::span(edges_).subspan(begins_[c], begins_[c + 1] - begins_[c]);
  }
  std::size_t size() const { return begins_.empty() ? 0 : begins_.size() - 1; }

private:
  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> cluster_of_, begins_, edges_;
};

}  // namespace aureole
