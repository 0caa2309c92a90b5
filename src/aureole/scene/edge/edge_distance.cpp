// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_distance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace aureole {

EdgeDistance::EdgeDistance(const EdgeIndex& index, float margin) : margin_(margin) {
  Bounds3 box;
  for (const MeshEdge& edge : index.edges()) box.extend(edge.a), box.extend(edge.b);
  if (box.empty()) return;
  // The grid extends half a cell beyond each side, for the rounding of coordinates.
  cell_ = (max_component(box.diagonal()) + 2 * margin) / (kCells - 1), per_length_ = 1 / cell_;
  const float half = 0.5f * kCells * cell_;
  lower_ = box.center() - Vec3{half, half, half};
  Rows reached(std::size_t(kCells) * kCells), before, grown;
  std::vector<float> lengths(reached.size() * kCells);
  for (const MeshEdge& edge : index.edges()) mark(edge.a, edge.b, reached, lengths);
  most_beside_ = *std::max_element(lengths.begin(), lengths.end()) * 2 * margin_ / (cell_ * cell_);
  // Distance 0: the cells near an edge; then the cells around them, and so on.
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

float EdgeDistance::free_along(const Vec3& o, const Vec3& d, float length) const {
  if (cells_.empty()) return std::max(length, 0.f);
  // The part of the ray inside the grid, which contains the margins of all edges, enlarged for rounding.
  const float room = 0.01f * cell_, size = kCells * cell_;
  float first = 0, last = length;
  for (int i = 0; i < 3; ++i) {
    const float t0 = (lower_[i] - room - o[i]) / d[i], t1 = (lower_[i] + size + room - o[i]) / d[i];
    first = std::max(first, std::min(t0, t1)), last = std::min(last, std::max(t0, t1));
  }
  // Coordinates in cells are relative to the ray's entry into the grid: distant origins would round the steps
  // off.
  const Vec3 entry = o + d * first;
  float begin[3], rate[3], inverse[3];
  for (int i = 0; i < 3; ++i)
    begin[i] = (entry[i] - lower_[i]) * per_length_, rate[i] = d[i] * per_length_, inverse[i] = 1 / rate[i];
  const float end = last - first, step = kStep * cell_;
  for (float t = 0; t < end;) {
    int cell[3];
    for (int i = 0; i < 3; ++i) cell[i] = std::clamp(int(begin[i] + rate[i] * t), 0, kCells - 1);
    const int free = cells_[row(cell[1], cell[2]) * kCells + std::size_t(cell[0])];
    if (free == 0) return first + t;
    // Steps out of this cell and out of the free cells around it.
    float next = kInfinity;
    for (int i = 0; i < 3; ++i) {
      if (rate[i] == 0) continue;
      const int side = cell[i] + (rate[i] > 0 ? free : 1 - free);
      next = std::min(next, (float(side) - begin[i]) * inverse[i]);
    }
    t = std::max(next, t) + step;
  }
  return std::max(length, 0.f);
}

void EdgeDistance::mark(const Vec3& a, const Vec3& b, Rows& rows, std::vector<float>& lengths) const {
  // A slanted edge fills a small part of its box: it is halved until its pieces are short.
  const Vec3 middle = 0.5f * (a + b);
  // Far from the origin a cell may be smaller than the rounding of coordinates.
  if (length_squared(b - a) > 0.25f * cell_ * cell_ && !(middle == a) && !(middle == b)) {
    mark(a, middle, rows, lengths), mark(middle, b, rows, lengths);
    return;
  }
  lengths[index_of(middle)] += length(b - a);
  const float margin = margin_ + 2 * kStep * cell_;
  int first[3], last[3];
  for (int i = 0; i < 3; ++i)
    first[i] = cell_of(std::min(a[i], b[i]) - margin, i), last[i] = cell_of(std::max(a[i], b[i]) + margin, i);
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) rows[row(y, z)] |= std::uint64_t(1) << x;
}

}  // namespace aureole
