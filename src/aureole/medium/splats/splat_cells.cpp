// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/splats/splat_cells.h"

#include <algorithm>
#include <cmath>

namespace aureole {

SplatCells::SplatCells(std::span<const Bounds3> boxes) {
  for (const Bounds3& box : boxes) bounds_.extend(box);
  // Splats of surfaces are thin, and bounds of large cells would be far above the extinction.
  const Vec3 size = max(bounds_.diagonal(), Vec3{1, 1, 1} * (1e-6f * max_component(bounds_.diagonal())));
  double wanted = std::clamp(32. * double(boxes.size()), 4096., double(1 << 24));
  constexpr double kMaxEntries = double(1 << 27);
  const auto range = [&](const Bounds3& box, int axis, int& from, int& to) {
    const float scale = per_length_[axis];
    const auto index = [&](float x) {
      return std::clamp(int(std::floor((x - bounds_.lower[axis]) * scale)), 0, size_[std::size_t(axis)] - 1);
    };
    from = index(box.lower[axis]), to = index(box.upper[axis]);
  };
  for (;;) {
    const double edge = std::cbrt(double(size.x) * double(size.y) * double(size.z) / wanted);
    for (int axis = 0; axis < 3; ++axis) {
      size_[std::size_t(axis)] = int(std::clamp(std::ceil(double(size[axis]) / edge), 1., 1024.));
      per_length_[axis] = float(size_[std::size_t(axis)]) / size[axis];
    }
    double entries = 0;
    for (const Bounds3& box : boxes) {
      double n = 1;
      for (int axis = 0; axis < 3; ++axis) {
        int from, to;
        range(box, axis, from, to);
        n *= double(to - from + 1);
      }
      entries += n;
    }
    if (entries <= kMaxEntries || wanted <= 64) break;
    wanted /= 8;
  }
  const std::size_t nx = std::size_t(size_[0]), ny = std::size_t(size_[1]), nz = std::size_t(size_[2]);
  first_.assign(nx * ny * nz + 1, 0);
  const auto for_cells = [&](std::size_t i, const auto& visit) {
    int from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) range(boxes[i], axis, from[axis], to[axis]);
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          visit((std::size_t(z) * ny + std::size_t(y)) * nx + std::size_t(x));
  };
  for (std::size_t i = 0; i < boxes.size(); ++i) for_cells(i, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  entries_.resize(std::size_t(first_.back()));
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for_cells(i, [&](std::size_t cell) { entries_[std::size_t(next[cell]++)] = std::uint32_t(i); });
}

std::size_t SplatCells::cell_of(const Vec3& p) const {
  std::size_t cell = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const float x = (p[axis] - bounds_.lower[axis]) * per_length_[axis];
    if (!(x >= 0 && x <= float(size_[std::size_t(axis)]))) return count();
    cell = cell * std::size_t(size_[std::size_t(axis)]) +
           std::size_t(std::min(int(x), size_[std::size_t(axis)] - 1));
  }
  return cell;
}

Bounds3 SplatCells::box(std::size_t cell) const {
  const std::size_t nx = std::size_t(size_[0]), ny = std::size_t(size_[1]);
  const Vec3 edge{1 / per_length_.x, 1 / per_length_.y, 1 / per_length_.z};
  Bounds3 box;
  box.lower = bounds_.lower + edge * Vec3{float(cell % nx), float(cell / nx % ny), float(cell / nx / ny)};
  box.upper = box.lower + edge;
  return box;
}

Transform SplatCells::to_box() const {
  return Transform::scale(double(per_length_.x) / size_[0], double(per_length_.y) / size_[1],
                          double(per_length_.z) / size_[2]) *
         Transform::translate(-double(bounds_.lower.x), -double(bounds_.lower.y), -double(bounds_.lower.z));
}

}  // namespace aureole
