// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_distance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace aureole {

EdgeDistance::EdgeDistance(const EdgeIndex& index) {
  Bounds3 box;
  for (const MeshEdge& edge : index.edges()) box.extend(edge.a), box.extend(edge.b);
  if (box.empty()) return;
  // Half a cell more on each side, for the rounding of coordinates.
  cell_ = max_component(box.diagonal()) / (kCells - 1), per_length_ = 1 / cell_;
  const float half = 0.5f * kCells * cell_;
  lower_ = box.center() - Vec3{half, half, half};
  Rows reached(std::size_t(kCells) * kCells), before, grown;
  for (const MeshEdge& edge : index.edges()) mark(edge.a, edge.b, reached);
  // The cells that have an edge, those around them, and so on.
  cells_.assign(reached.size() * kCells, 0);
  before.assign(reached.size(), 0);
  for (int distance = 0; before != reached; ++distance) {
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (std::uint64_t bits = reached[i] & ~before[i]; bits; bits &= bits - 1)
        cells_[i * kCells + std::size_t(std::countr_zero(bits))] = std::uint8_t(distance);
    before = reached;
    for (std::uint64_t& bits : reached) bits |= bits << 1 | bits >> 1;
    for (const auto& [dy, dz] : {std::pair{1, 0}, std::pair{0, 1}}) {
      grown = reached;
      for (int z = 0; z < kCells; ++z)
        for (int y = 0; y < kCells; ++y) {
          if (y + dy < kCells && z + dz < kCells) grown[row(y, z)] |= reached[row(y + dy, z + dz)];
          if (y >= dy && z >= dz) grown[row(y, z)] |= reached[row(y - dy, z - dz)];
        }
      reached = grown;
    }
  }
}

void EdgeDistance::mark(const Vec3& a, const Vec3& b, Rows& rows) const {
  // Slanted edges fill a small part of their boxes.
  const Vec3 middle = 0.5f * (a + b);
  // Far from the origin a cell may be less than the rounding of coordinates.
  if (length_squared(b - a) > 0.25f * cell_ * cell_ && !(middle == a) && !(middle == b)) {
    mark(a, middle, rows), mark(middle, b, rows);
    return;
  }
  int first[3], last[3];
  for (int i = 0; i < 3; ++i)
    first[i] = cell_of(std::min(a[i], b[i]), i), last[i] = cell_of(std::max(a[i], b[i]), i);
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) rows[row(y, z)] |= std::uint64_t(1) << x;
}

}  // namespace aureole
