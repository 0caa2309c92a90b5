// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/uv_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace aureole {

UvIndex::UvIndex(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  struct Cells {
    int x0, x1, y0, y1;
  };
  const auto cells_of = [&](const Triangle& t) -> Cells {
    const auto [u0, u1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [v0, v1] = std::minmax({t[0].y, t[1].y, t[2].y});
    if (!(u1 >= 0 && u0 <= 1 && v1 >= 0 && v0 <= 1)) return {0, -1, 0, -1};
    return {cell_of(u0), cell_of(u1), cell_of(v0), cell_of(v1)};
  };
  // Where pictures repeat over a mesh, triangles cover many cells, so that larger cells are used.
  const auto entries = [&] {
    double sum = 0;
    for (const Triangle& t : triangles_) {
      const Cells c = cells_of(t);
      sum += double(c.x1 - c.x0 + 1) * double(c.y1 - c.y0 + 1);
    }
    return sum;
  };
  side_ = std::clamp(int(std::sqrt(double(triangles_.size()))), 1, 4096);
  while (side_ > 1 && entries() > 16 * double(triangles_.size())) side_ /= 2;

  begin_.assign(size_t(side_) * size_t(side_) + 1, 0);
  const auto for_each_cell = [&](const Triangle& t, const auto& use) {
    const Cells c = cells_of(t);
    for (int y = c.y0; y <= c.y1; ++y)
      for (int x = c.x0; x <= c.x1; ++x) use(size_t(y) * size_t(side_) + size_t(x));
  };
  // Counting sort: the counts become ends, and filling backward turns them into starts.
  for (const Triangle& t : triangles_) for_each_cell(t, [&](size_t cell) { ++begin_[cell]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  in_cells_.resize(begin_.back());
  for (size_t i = triangles_.size(); i-- > 0;)
    for_each_cell(triangles_[i], [&](size_t cell) { in_cells_[--begin_[cell]] = std::uint32_t(i); });
}

int UvIndex::cell_of(float x) const { return int(std::clamp(x * float(side_), 0.f, float(side_ - 1))); }

std::optional<UvIndex::Place> UvIndex::find(Vec2 uv) const {
  const size_t cell = size_t(cell_of(uv.y)) * size_t(side_) + size_t(cell_of(uv.x));
  for (auto k = begin_[cell]; k < begin_[cell + 1]; ++k) {
    const Triangle& t = triangles_[in_cells_[k]];
    const double ax = double(t[1].x) - t[0].x, ay = double(t[1].y) - t[0].y;
    const double bx = double(t[2].x) - t[0].x, by = double(t[2].y) - t[0].y;
    const double x = double(uv.x) - t[0].x, y = double(uv.y) - t[0].y, area = ax * by - ay * bx;
    if (area == 0) continue;
    const double b1 = (x * by - y * bx) / area, b2 = (ax * y - ay * x) / area;
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return Place{in_cells_[k], {float(b1), float(b2)}};
  }
  return {};
}

}  // namespace aureole
