// SPDX-License-Identifier: Apache-2.0
// `EdgeDistance`: about how far places are from the nearest edge of a scene, at the price of a look into a grid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {

class EdgeDistance {
public:
  EdgeDistance() = default;
  /// `margin`: the distance from edges that `free_along` asks for.
  EdgeDistance(const EdgeIndex& index, float margin);

  /// A distance within which no edge is; 0 within the margin and a cell or two of an edge.
  float at_least(const Vec3& p) const {
    if (cells_.empty()) return kInfinity;
    const int cells = cells_[index_of(p)];
    return cells > 0 ? float(cells - 1) * cell_ + margin_ : 0;
  }
  /// How far along a ray, of unit direction, no edge is within the margin: perhaps farther than that, but nowhere before `length` where it
  /// is `length`.
  float free_along(const Vec3& o, const Vec3& d, float length) const;
  /// Of the ways through a cell, the largest part of which an edge is within the margin, about; may be above 1.
  float most_beside() const { return most_beside_; }
  /// The length of a cell: about 1/63 of that of all edges with the margin around them.
  float cell() const { return cell_; }

private:
  static constexpr int kCells = 64;  ///< along an axis
  /// Of rays, at least, from cell to cell: they may miss as much of a corner.
  static constexpr float kStep = 0.001f;

  using Rows = std::vector<std::uint64_t>;  ///< of cells along x, a bit each

  static std::size_t row(int y, int z) { return std::size_t(z * kCells + y); }
  std::size_t index_of(const Vec3& p) const {
    return row(cell_of(p.y, 1), cell_of(p.z, 2)) * kCells + std::size_t(cell_of(p.x, 0));
  }
  int cell_of(float v, int axis) const {
    return int(std::clamp((v - lower_[axis]) * per_length_, 0.f, float(kCells - 1)));
  }
  /// Adds the length of the edge to the cells of `lengths`, too.
  void mark(const Vec3& a, const Vec3& b, Rows& rows, std::vector<float>& lengths) const;

  Vec3 lower_{};
  float cell_ = 0, per_length_ = 0, margin_ = 0, most_beside_ = 0;
  std::vector<std::uint8_t>
      cells_;  ///< how many cells away the nearest one with the margin of an edge is: the
               ///< greatest of the three differences
};

}  // namespace aureole
