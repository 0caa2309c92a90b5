// SPDX-License-Identifier: Apache-2.0
// Groups of edges that all lie within one beam and apart from all others, such as those of a small hole: their waves are summed at once.
#pragma once

#include <algorithm>
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

  /// The cluster of an edge, or `size()` where it belongs to none.
  std::size_t number_of(std::size_t edge) const {
    return cluster_of_.empty() || cluster_of_[edge] == kNone ? size() : cluster_of_[edge];
  }
  /// The numbers of the edges in a cluster, ascending.
  std::span<const std::uint32_t> edges(std::size_t cluster) const {
    return std::span(edges_).subspan(begins_[cluster], begins_[cluster + 1] - begins_[cluster]);
  }
  /// Those of the cluster of an edge; empty where it belongs to none.
  std::span<const std::uint32_t> of(std::size_t edge) const {
    const std::size_t cluster = number_of(edge);
    return cluster == size() ? std::span<const std::uint32_t>() : edges(cluster);
  }
  /// The place of an edge of a cluster among its `edges`.
  std::size_t place_of(std::size_t edge) const {
    const auto all = edges(number_of(edge));
    return std::size_t(std::ranges::lower_bound(all, edge) - all.begin());
  }
  std::size_t size() const { return begins_.empty() ? 0 : begins_.size() - 1; }

private:
  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> cluster_of_, begins_, edges_;
};

}  // namespace aureole
