// SPDX-License-Identifier: Apache-2.0
// `SplatCells`: the cells of a regular grid that list the boxes which reach them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/transform.h"

namespace aureole {

class SplatCells {
public:
  SplatCells() = default;
  /// Some 32 cells a box, as cubes; fewer where boxes are so large that the lists would be too long.
  explicit SplatCells(std::span<const Bounds3> boxes);

  const Bounds3& bounds() const { return bounds_; }
  const std::array<int, 3>& size() const { return size_; }
  std::size_t count() const { return first_.size() - 1; }
  /// Returns the number of the cell that holds a point; count() outside of the bounds.
  std::size_t cell_of(const Vec3& p) const;
  Bounds3 box(std::size_t cell) const;
  /// Indices of the boxes that reach a cell.
  std::span<const std::uint32_t> entries(std::size_t cell) const {
    return std::span(entries_).subspan(std::size_t(first_[cell]),
                                       std::size_t(first_[cell + 1] - first_[cell]));
  }
  /// From the world to the box [0, 1]^3 that the cells divide.
  Transform to_box() const;
  std::size_t memory_bytes() const {
    return first_.size() * sizeof(std::uint64_t) + entries_.size() * sizeof(std::uint32_t);
  }

private:
  Bounds3 bounds_;
  std::array<int, 3> size_{1, 1, 1};
  Vec3 per_length_;                         ///< cells per length along each axis
  std::vector<std::uint64_t> first_ = {0};  ///< index of each cell's first entry
  std::vector<std::uint32_t> entries_;
};

}  // namespace aureole
