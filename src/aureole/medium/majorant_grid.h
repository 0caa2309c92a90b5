// SPDX-License-Identifier: Apache-2.0
// `MajorantGrid`: upper bounds of a medium's density in the cells of a regular grid, and the traversal of a
// ray through them. An empty cell stores the size of the largest aligned block of 2^k cells along each axis
// that contains it and is empty, so that a ray crosses empty space block by block.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "aureole/math/transform.h"

namespace aureole {

class MajorantGrid {
public:
  /// `to_box` maps world space to the box [0, 1]^3, which is divided into cells of equal size. `bounds` has
  /// one value per cell, x fastest.
  MajorantGrid(const Transform& to_box, const std::array<int, 3>& cells, std::vector<float> bounds);
  /// Shares the bounds of `grid` under another transform: `to_its_world` maps world space to the space in
  /// which `grid` lies.
  MajorantGrid(const MajorantGrid& grid, const Transform& to_its_world);

  /// A segment of a ray along which one bound holds.
  struct Piece {
    float begin, end;  ///< distances along the ray
    float bound;       ///< upper bound of the density, positive
  };

  /// Traverses a ray's segments in order, from its origin to the distance t_max (Amanatides & Woo 1987, "A
  /// fast voxel traversal algorithm for ray tracing"). Cells with a bound of 0 are skipped.
  class Walk {
  public:
    /// `ray.d` has unit length.
    Walk(const MajorantGrid& grid, const Ray& ray, float t_max);
    /// Stores the next segment in `piece`. Returns false if there is none.
    bool next(Piece& piece);

  private:
    void cross_empty_block(int level);

    const MajorantGrid* grid_ = nullptr;
    float t_ = 0, end_ = 0;
    int cell_ = 0;                           ///< index of the current cell
    int left_[3] = {};                       ///< cells between the current one and the border of the grid,
                                             ///< along each axis
    int stride_[3] = {};                     ///< signed step to the index of the next cell
    float crossing_[3] = {}, step_[3] = {};  ///< distance of the next face across an axis; distance between
                                             ///< faces
  };

  const std::array<int, 3>& cells() const { return cells_; }
  const Transform& to_box() const { return to_box_; }
  /// Returns the bound at a point in world space; zero outside the box.
  float at(const Vec3& p) const;
  float maximum() const { return maximum_; }
  std::size_t memory_bytes() const { return count_ * sizeof(float); }

private:
  void set_rows();
  void find_empty_blocks(std::vector<float>& bounds) const;

  Transform to_box_;
  float rows_[3][4];  ///< world space to coordinates in units of cells
  std::array<int, 3> cells_;
  /// Bounds of the cells; for an empty cell -k, where 2^k is the size of its empty block. Copies share them.
  std::shared_ptr<const float[]> bounds_;
  std::size_t count_ = 0;
  float maximum_ = 0;
};

}  // namespace aureole
