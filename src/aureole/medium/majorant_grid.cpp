// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/majorant_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {

MajorantGrid::MajorantGrid(const Transform& to_box, const std::array<int, 3>& cells,
                           std::vector<float> bounds)
    : cells_(cells), bounds_(std::move(bounds)) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) rows_[i][j] = float(to_box.matrix()[size_t(i)][size_t(j)] * cells[size_t(i)]);
  for (const float b : bounds_) maximum_ = std::max(maximum_, b);
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
  bounds_ = grid.bounds_.data();
  t_ = begin, end_ = end;
}

bool MajorantGrid::Walk::next(Piece& piece) {
  while (t_ < end_) {
    const int axis = crossing_[0] < crossing_[1] ? (crossing_[0] < crossing_[2] ? 0 : 2)
                                                 : (crossing_[1] < crossing_[2] ? 1 : 2);
    const float from = t_, to = std::min(crossing_[axis], end_), bound = bounds_[cell_];
    // Rounding may put the first faces before the beginning: such cells are passed at once.
    t_ = std::max(from, to);
    if (left_[axis]-- > 0)
      cell_ += stride_[axis], crossing_[axis] += step_[axis];
    else if (crossing_[axis] < end_)
      // The last cell of the axis: its end is that of the grid, up to rounding.
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

}  // namespace aureole
