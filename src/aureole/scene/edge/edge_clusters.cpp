// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_clusters.h"

#include <algorithm>

namespace aureole {
namespace {

/// Larger groups are no clusters. The search ends there, since each edge of a group visits all others.
constexpr std::size_t kMostEdges = 1024;

/// Largest thickness of a flat group, over its length.
constexpr float kThickest = 0.1f;

Bounds3 box_of(const MeshEdge& edge) {
  Bounds3 box;
  box.extend(edge.a), box.extend(edge.b);
  return box;
}

/// Returns an estimate of how far the edges leave a plane through three of their vertices that lie far apart.
float thickness(const std::vector<MeshEdge>& edges, const std::vector<std::uint32_t>& group) {
  const auto farthest = [&](const auto& distance) {
    Vec3 best = edges[group[0]].a;
    for (const std::uint32_t i : group)
      for (const Vec3& p : {edges[i].a, edges[i].b})
        if (distance(p) > distance(best)) best = p;
    return best;
  };
  const Vec3 first = edges[group[0]].a;
  const Vec3 a = farthest([&](const Vec3& p) { return length_squared(p - first); });
  const Vec3 b = farthest([&](const Vec3& p) { return length_squared(p - a); });
  const Vec3 c = farthest([&](const Vec3& p) { return length_squared(cross(p - a, b - a)); });
  const Vec3 n = cross(b - a, c - a);
  if (!(length_squared(n) > 0)) return 0;
  const Vec3 normal = normalize(n);
  float low = 0, high = 0;
  for (const std::uint32_t i : group)
    for (const Vec3& p : {edges[i].a, edges[i].b})
      low = std::min(low, dot(p - a, normal)), high = std::max(high, dot(p - a, normal));
  return high - low;
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
        if (states[other] == present ||
            squared_distance(box_of(edges[other]), box_of(edges[group[i]])) > coherent * coherent)
          return true;
        // An edge of a group that is too large or too long belongs to that group.
        if (states[other] == apart || group.size() == kMostEdges) return false;
        states[other] = present;
        group.push_back(other);
        box.extend(box_of(edges[other]));
        return length(box.diagonal()) <= longest;
      });
    const bool is_cluster =
        fits && group.size() >= kFewest && thickness(edges, group) <= kThickest * length(box.diagonal());
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
