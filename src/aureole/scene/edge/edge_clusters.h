// SPDX-License-Identifier: Apache-2.0
// Groups of edges that all lie within one beam and apart from all others, such as those of a small hole:
// their waves are summed at once.
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
  /// Finds the clusters. Edges whose boxes lie within `coherent` of one another, directly or through other
  /// edges, belong together. A cluster has at least kFewest edges, is no longer than 2 `coherent`, and is
  /// flat, so that no edge lies behind another one. No edge outside it lies within `coherent` of an edge
  /// inside.
  EdgeClusters(const EdgeIndex& index, float coherent);

  /// Fewest edges of a cluster: pairs of fewer edges cost little, and random wave vectors add noise.
  static constexpr std::size_t kFewest = 16;

  /// Returns the number of the cluster of an edge, or `size()` if it belongs to none.
  std::size_t number_of(std::size_t edge) const {
    return cluster_of_.empty() || cluster_of_[edge] == kNone ? size() : cluster_of_[edge];
  }
  /// Returns the numbers of the edges in a cluster, in ascending order.
  std::span<const std::uint32_t> edges(std::size_t cluster) const {
    return std::span(edges_).subspan(begins_[cluster], begins_[cluster + 1] - begins_[cluster]);
  }
  /// Returns the edges of the cluster to which an edge belongs; empty if it belongs to none.
  std::span<const std::uint32_t> of(std::size_t edge) const {
    const std::size_t cluster = number_of(edge);
    return cluster == size() ? std::span<const std::uint32_t>() : edges(cluster);
  }
  /// Returns the position of an edge of a cluster among the cluster's `edges`.
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
