// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/majorant_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {

MajorantGrid::MajorantGrid(const Transform& to_box, const std::array<int, 3>& cells,
                           std::vector<float> bounds)
    : to_box_(to_box), cells_(cells), count_(bounds.size()) {
  set_rows();
  for (const float b : bounds) maximum_ = std::max(maximum_, b);
  find_empty_blocks(bounds);
  const auto kept = std::make_shared<std::vector<float>>(std::move(bounds));
  bounds_ = std::shared_ptr<const float[]>(kept, kept->data());
}

MajorantGrid::MajorantGrid(const MajorantGrid& grid, const Transform& to_its_world) : MajorantGrid(grid) {
  to_box_ = grid.to_box_ * to_its_world;
  set_rows();
}

void MajorantGrid::set_rows() {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      rows_[i][j] = float(to_box_.matrix()[size_t(i)][size_t(j)] * cells_[size_t(i)]);
}

void MajorantGrid::find_empty_blocks(std::vector<float>& bounds) const {
  const auto place = [](const std::array<int, 3>& n, int x, int y, int z) {
    return (size_t(z) * size_t(n[1]) + size_t(y)) * size_t(n[0]) + size_t(x);
  };
  // Empty blocks are found level by level: a block is empty if its sub-blocks of half the size are. Blocks at
  // the border may extend beyond the grid.
  std::array<int, 3> n = cells_;
  std::vector<char> empty(bounds.size());
  for (size_t i = 0; i < bounds.size(); ++i) {
    bounds[i] = std::max(bounds[i], 0.f);
    empty[i] = bounds[i] == 0;
  }
  for (int level = 1; n[0] > 1 || n[1] > 1 || n[2] > 1; ++level) {
    const std::array<int, 3> half = n;
    for (int& k : n) k = (k + 1) / 2;
    std::vector<char> merged(size_t(n[0]) * size_t(n[1]) * size_t(n[2]), 1);
    for (int z = 0; z < half[2]; ++z)
      for (int y = 0; y < half[1]; ++y)
        for (int x = 0; x < half[0]; ++x)
          merged[place(n, x / 2, y / 2, z / 2)] &= empty[place(half, x, y, z)];
    if (std::none_of(merged.begin(), merged.end(), [](char e) { return e; })) return;
    for (int z = 0; z < cells_[2]; ++z)
      for (int y = 0; y < cells_[1]; ++y)
        for (int x = 0; x < cells_[0]; ++x)
          if (merged[place(n, x >> level, y >> level, z >> level)])
            bounds[place(cells_, x, y, z)] = -float(level);
    empty = std::move(merged);
  }
}

float MajorantGrid::at(const Vec3& p) const {
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    const float* m = rows_[i];
    const float x = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    const int n = cells_[size_t(i)];
    if (!(x >= 0 && x <= float(n))) return 0;
    cell[i] = std::min(int(x), n - 1);
  }
  const size_t index =
      (size_t(cell[2]) * size_t(cells_[1]) + size_t(cell[1])) * size_t(cells_[0]) + size_t(cell[0]);
  return std::max(bounds_[std::ptrdiff_t(index)], 0.f);
}

MajorantGrid::Walk::Walk(const MajorantGrid& grid, const Ray& ray, float t_max) {
  float begin = 0, end = t_max, o[3], d[3];
  for (int i = 0; i < 3; ++i) {
    const float* m = grid.rows_[i];
    o[i] = m[0] * ray.o.x + m[1] * ray.o.y + m[2] * ray.o.z + m[3];
    d[i] = m[0] * ray.d.x + m[1] * ray.d.y + m[2] * ray.d.z;
    const float cells = float(grid.cells_[size_t(i)]);
    if (d[i] == 0) {
      if (!(o[i] >= 0 && o[i] <= cells)) return;
      continue;
    }
    const float t0 = -o[i] / d[i], t1 = (cells - o[i]) / d[i];
    begin = std::max(begin, std::min(t0, t1)), end = std::min(end, std::max(t0, t1));
  }
  if (!(begin < end)) return;
  int stride = 1;
  for (int i = 0; i < 3; ++i) {
    const int cells = grid.cells_[size_t(i)];
    const int at = std::clamp(int(std::floor(o[i] + d[i] * begin)), 0, cells - 1);
    cell_ += at * stride;
    if (d[i] == 0) {
      crossing_[i] = step_[i] = std::numeric_limits<float>::infinity();
    } else {
      const bool up = d[i] > 0;
      step_[i] = 1 / std::abs(d[i]);
      crossing_[i] = (float(at + up) - o[i]) / d[i];
      left_[i] = up ? cells - 1 - at : at;
      stride_[i] = up ? stride : -stride;
    }
    stride *= cells;
  }
  grid_ = &grid;
  t_ = begin, end_ = end;
}

bool MajorantGrid::Walk::next(Piece& piece) {
  while (t_ < end_) {
    const float bound = grid_->bounds_[cell_];
    if (bound < 0) {
      cross_empty_block(int(-bound));
      continue;
    }
    const int axis = crossing_[0] < crossing_[1] ? (crossing_[0] < crossing_[2] ? 0 : 2)
                                                 : (crossing_[1] < crossing_[2] ? 1 : 2);
    const float from = t_, to = std::min(crossing_[axis], end_);
    // Rounding may put the first faces before the ray's start; the loop skips such cells.
    t_ = std::max(from, to);
    if (left_[axis]-- > 0)
      cell_ += stride_[axis], crossing_[axis] += step_[axis];
    else if (crossing_[axis] < end_)
      // The last cell of the axis ends with the grid, up to rounding.
      crossing_[axis] = end_;
    else
      t_ = end_;
    if (bound > 0 && to > from) {
      piece = {from, to, bound};
      return true;
    }
  }
  return false;
}

/// Advances to the exit of the aligned block of 2^level cells along each axis that contains the current cell.
void MajorantGrid::Walk::cross_empty_block(int level) {
  const int mask = (1 << level) - 1;
  int inside[3];  // number of cells of the block after the current one along each axis
  float far[3];
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    const int at = stride_[i] > 0 ? grid_->cells_[size_t(i)] - 1 - left_[i] : left_[i];
    inside[i] = std::min(stride_[i] > 0 ? mask - (at & mask) : at & mask, left_[i]);
    far[i] = inside[i] > 0 ? crossing_[i] + float(inside[i]) * step_[i] : crossing_[i];
    if (far[i] < far[axis]) axis = i;
  }
  const float to = far[axis];
  t_ = std::max(t_, to);
  if (inside[axis] == left_[axis] || !(to < end_)) {  // The ray leaves the grid, or ends within the block.
    t_ = end_;
    return;
  }
  for (int i = 0; i < 3; ++i) {
    // Along the other axes, count the faces crossed before the distance `to`.
    const int passed = i == axis           ? inside[i] + 1
                       : crossing_[i] < to ? std::min(int((to - crossing_[i]) / step_[i]) + 1, inside[i])
                                           : 0;
    if (passed == 0) continue;
    left_[i] -= passed, cell_ += passed * stride_[i];
    crossing_[i] += float(passed) * step_[i];
  }
}

}  // namespace aureole
