// SPDX-License-Identifier: Apache-2.0
// `EdgeDistance`: a lower bound of the distance of points from the nearest edge of a scene, by one look-up in
// a grid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {

class EdgeDistance {
public:
  EdgeDistance() = default;
  /// `margin` is the distance from edges that `free_along` keeps.
  EdgeDistance(const EdgeIndex& index, float margin);

  /// Returns a distance within which there is no edge; 0 within the margin and a cell or two of an edge.
  float at_least(const Vec3& p) const {
    if (cells_.empty()) return kInfinity;
    const int cells = cells_[index_of(p)];
    return cells > 0 ? float(cells - 1) * cell_ + margin_ : 0;
  }
  /// Returns a distance along a ray, of unit direction, up to which no edge is within the margin. The free
  /// part of the ray may be longer, unless the result is `length`.
  float free_along(const Vec3& o, const Vec3& d, float length) const;
  /// Returns an estimate, which may exceed 1, of the largest fraction, over all cells, of the rays through a
  /// cell that pass within the margin of an edge.
  float most_beside() const { return most_beside_; }
  /// Returns the length of a cell, about 1/63 of the extent of all edges and the margin around them.
  float cell() const { return cell_; }

private:
  static constexpr int kCells = 64;  ///< along each axis
  /// Smallest step of a ray between cells, in cells: corners of cells smaller than that may be missed.
  static constexpr float kStep = 0.001f;

  using Rows = std::vector<std::uint64_t>;  ///< rows of cells along x, one bit per cell

  static std::size_t row(int y, int z) { return std::size_t(z * kCells + y); }
  std::size_t index_of(const Vec3& p) const {
    return row(cell_of(p.y, 1), cell_of(p.z, 2)) * kCells + std::size_t(cell_of(p.x, 0));
  }
  int cell_of(float v, int axis) const {
    return int(std::clamp((v - lower_[axis]) * per_length_, 0.f, float(kCells - 1)));
  }
  /// Marks the cells within the margin of an edge in `rows`, and adds the edge's length to cells of
  /// `lengths`.
  void mark(const Vec3& a, const Vec3& b, Rows& rows, std::vector<float>& lengths) const;

  Vec3 lower_{};
  float cell_ = 0, per_length_ = 0, margin_ = 0, most_beside_ = 0;
  /// For each cell, the number of cells to the nearest cell within the margin of an edge: the largest
  /// difference along the three axes.
  std::vector<std::uint8_t> cells_;
};

}  // namespace aureole
