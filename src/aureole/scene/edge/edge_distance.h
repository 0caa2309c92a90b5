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
  explicit EdgeDistance(const EdgeIndex& index);

  /// A distance within which no edge is; 0 within a cell or two of an edge.
  float at_least(const Vec3& p) const {
    if (cells_.empty()) return kInfinity;
    const std::size_t i = row(cell_of(p.y, 1), cell_of(p.z, 2)) * kCells + std::size_t(cell_of(p.x, 0));
    return float(std::max(int(cells_[i]) - 1, 0)) * cell_;
  }
  /// The length of a cell: 1/63 of that of all edges.
  float cell() const { return cell_; }

private:
  static constexpr int kCells = 64;  ///< along an axis

  using Rows = std::vector<std::uint64_t>;  ///< of cells along x, a bit each

  static std::size_t row(int y, int z) { return std::size_t(z * kCells + y); }
  int cell_of(float v, int axis) const {
    return int(std::clamp((v - lower_[axis]) * per_length_, 0.f, float(kCells - 1)));
  }
  void mark(const Vec3& a, const Vec3& b, Rows& rows) const;

  Vec3 lower_{};
  float cell_ = 0, per_length_ = 0;
  std::vector<std::uint8_t>
      cells_;  ///< how many cells away the nearest one with an edge is: the greatest of the three differences
};

}  // namespace aureole
