// SPDX-License-Identifier: Apache-2.0
// `MajorantGrid`: upper bounds of a medium's density in the cells of a regular grid, and the walk of a ray
// through them. Empty space is crossed in strides: an empty cell knows the largest block of 2^k cells along each
// axis, aligned to multiples of that, that holds it and is empty throughout.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "aureole/math/transform.h"

namespace aureole {

class MajorantGrid {
public:
  /// `to_box` takes the world to the box [0, 1]^3, which is divided into cells of equal size; `bounds` has one
  /// number per cell, x fastest.
  MajorantGrid(const Transform& to_box, const std::array<int, 3>& cells, std::vector<float> bounds);

  /// A part of a ray in which one bound holds.
  struct Piece {
    float begin, end;  ///< distances along the ray
    float bound;       ///< positive
  };

  /// The pieces of a ray from its origin to the distance t_max, in order (Amanatides & Woo 1987, "A fast voxel
  /// traversal algorithm for ray tracing"). Cells with a bound of 0 are left out.
  class Walk {
  public:
    /// `ray.d` has unit length.
    Walk(const MajorantGrid& grid, const Ray& ray, float t_max);
    /// False at the end.
    bool next(Piece& piece);

  private:
    void cross_empty_block(int level);

    const MajorantGrid* grid_ = nullptr;
    float t_ = 0, end_ = 0;
    int cell_ = 0;                           ///< index of the present one
    int left_[3] = {};                       ///< cells up to the border of the grid along each axis
    int stride_[3] = {};                     ///< to the index of the next cell, with its sign
    float crossing_[3] = {}, step_[3] = {};  ///< distance of the next face across an axis, and between two
  };

  const std::array<int, 3>& cells() const { return cells_; }
  const Transform& to_box() const { return to_box_; }
  /// The bound at a point of the world; zero outside of the box.
  float at(const Vec3& p) const;
  float maximum() const { return maximum_; }
  std::size_t memory_bytes() const { return bounds_.size() * sizeof(float); }

private:
  void find_empty_blocks();

  Transform to_box_;
  float rows_[3][4];  ///< from the world to coordinates in cells
  std::array<int, 3> cells_;
  std::vector<float> bounds_;  ///< of empty cells -k, the level of their block
  float maximum_ = 0;
};

}  // namespace aureole
