// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_clusters.h"

#include <algorithm>

namespace aureole {
namespace {

/// Larger groups are no clusters; looking for one ends there, so that the time does not grow with the square of the number of edges.
constexpr std::size_t kMostEdges = 4096;

Bounds3 box_of(const MeshEdge& edge) {
  Bounds3 box;
  box.extend(edge.a), box.extend(edge.b);
  return box;
}

}  // namespace

EdgeClusters::EdgeClusters(const EdgeIndex& index, float coherent) {
  const std::vector<MeshEdge>& edges = index.edges();
  if (edges.size() < kFewest) return;
  enum State : std::uint8_t { unseen, present, settled, apart };
  std::vector<State> states(edges.size(), unseen);
  cluster_of_.assign(edges.size(), kNone);
  begins_ = {0};
  std::vector<std::uint32_t> group;
  const float longest = 2 * coherent;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (states[first] != unseen) continue;
    group = {std::uint32_t(first)};
    states[first] = present;
    Bounds3 box = box_of(edges[first]);
    bool fits = length(box.diagonal()) <= longest;
    for (std::size_t i = 0; fits && i < group.size(); ++i)
      fits = index.visit_within(box_of(edges[group[i]]), coherent, [&](std::uint32_t other) {
        // What is settled lies farther away: else it would have found this edge.
        if (states[other] == present || states[other] == settled) return true;
        // An edge of a group that is too large or too long belongs to that.
        if (states[other] == apart || group.size() == kMostEdges) return false;
        states[other] = present;
        group.push_back(other);
        box.extend(box_of(edges[other]));
        return length(box.diagonal()) <= longest;
      });
    const bool is_cluster = fits && group.size() >= kFewest;
    for (const std::uint32_t i : group) states[i] = fits ? settled : apart;
    if (!is_cluster) continue;
    std::sort(group.begin(), group.end());
    for (const std::uint32_t i : group) cluster_of_[i] = std::uint32_t(begins_.size() - 1);
    edges_.insert(edges_.end(), group.begin(), group.end());
    begins_.push_back(std::uint32_t(edges_.size()));
  }
  if (edges_.empty()) cluster_of_.clear(), begins_.clear();
}

}  // namespace aureole
