// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/open_edges.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace aureole {

std::size_t count_open_edges(std::span<const Mesh* const> meshes) {
  // All corners with the index of their position, sorted by position.
  std::vector<std::pair<Vec3, std::uint32_t>> corners;
  for (const Mesh* mesh : meshes)
    for (const TriangleIndices& t : mesh->data().triangles)
      for (const std::uint32_t v : t)
        corners.emplace_back(mesh->data().positions[v], std::uint32_t(corners.size()));
  // key for sorting, which compares -0 and 0 equal
  const auto key = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };
  std::sort(corners.begin(), corners.end(),
            [&](const auto& a, const auto& b) { return key(a.first) < key(b.first); });
  std::vector<std::uint32_t> position(corners.size());
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i > 0 && key(corners[i].first) != key(corners[i - 1].first)) ++number;
    position[corners[i].second] = number;
  }
  std::vector<std::uint64_t> edges;
  edges.reserve(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    const std::uint64_t a = position[i], b = position[i % 3 == 2 ? i - 2 : i + 1];
    if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b));
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    open += (end - i) % 2;
    i = end;
  }
  return open;
}

std::string open_edges_text(std::size_t count) {
  if (count == 0) return {};
  return count == 1 ? "1 edge belongs to one triangle alone"
                    : std::to_string(count) + " edges belong to one triangle alone";
}

std::string Mesh::opening() const {
  std::call_once(opening_is_known_, [this] {
    const Mesh* const self = this;
    opening_ = open_edges_text(count_open_edges({&self, 1}));
  });
  return opening_;
}

}  // namespace aureole
