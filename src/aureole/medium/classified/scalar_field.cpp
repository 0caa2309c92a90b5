// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/scalar_field.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {

ScalarField::ScalarField(const Volume& volume)
    : to_box_(volume.to_box().value_or(Transform())), size_(volume.resolution()) {
  for (std::size_t k = 0; k < 3; ++k) padded_[k] = std::max(size_[k], 2);
  stride_[0] = 1, stride_[1] = std::size_t(padded_[0]), stride_[2] = stride_[1] * std::size_t(padded_[1]);
  const auto& m = to_box_.matrix();
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) rows_[r][c] = float(m[r][c] * size_[r] - (c == 3 ? 0.5 : 0.0));
  const Transform from_box = to_box_.inverse();
  spacing_ = kInfinity;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k)
    spacing_ = std::min(spacing_, length(from_box.vector(axes[k])) / float(size_[std::size_t(k)]));
  values_.resize(stride_[2] * std::size_t(padded_[2]));
  for_ranges(
      std::size_t(padded_[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t z = begin; z < end; ++z)
          for (int y = 0; y < padded_[1]; ++y)
            for (int x = 0; x < padded_[0]; ++x) {
              const auto centre = [&](int i, std::size_t k) {
                return (float(std::min(i, size_[k] - 1)) + 0.5f) / float(size_[k]);
              };
              values_[z * stride_[2] + std::size_t(y) * stride_[1] + std::size_t(x)] =
                  volume.eval_scalar(from_box.point({centre(x, 0), centre(y, 1), centre(int(z), 2)}));
            }
      },
      1);
  minimum_ = kInfinity, maximum_ = -kInfinity;
  for (const float v : values_) {
    broken_ += !std::isfinite(v);
    minimum_ = std::min(minimum_, v), maximum_ = std::max(maximum_, v);
  }
}

Vec3 ScalarField::to_world_gradient(const Vec3& g) const {
  Vec3 out;
  for (int c = 0; c < 3; ++c) out[c] = rows_[0][c] * g.x + rows_[1][c] * g.y + rows_[2][c] * g.z;
  return out;
}

Vec3 ScalarField::gradient(const Vec3& p) const {
  const Vec3 i = index_of(p);
  const auto difference = [&](int k) {
    const float last = float(padded_[std::size_t(k)] - 1);
    Vec3 above = i, below = i;
    above[k] = std::clamp(i[k] + 1, 0.f, last), below[k] = std::clamp(i[k] - 1, 0.f, last);
    return (value_at_index(above) - value_at_index(below)) / (above[k] - below[k]);
  };
  return to_world_gradient({difference(0), difference(1), difference(2)});
}

std::vector<std::array<float, 2>> ScalarField::ranges(const std::array<int, 3>& cells) const {
  const std::size_t row = std::size_t(cells[0]), layer = row * std::size_t(cells[1]);
  std::vector<std::array<float, 2>> ranges(layer * std::size_t(cells[2]));
  const auto span = [&](int cell, std::size_t k) {
    const double step = double(size_[k]) / cells[k];
    // Interpolation within a cell uses the voxels up to half a voxel beyond its faces; the small part is for rounding.
    return std::array{std::clamp(int(std::floor(cell * step - 0.5 - 1e-3)), 0, padded_[k] - 1),
                      std::clamp(int(std::ceil((cell + 1) * step - 0.5 + 1e-3)), 0, padded_[k] - 1)};
  };
  for_ranges(
      std::size_t(cells[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t z = begin; z < end; ++z)
          for (int y = 0; y < cells[1]; ++y)
            for (int x = 0; x < cells[0]; ++x) {
              const auto sx = span(x, 0), sy = span(y, 1), sz = span(int(z), 2);
              std::array<float, 2> range{kInfinity, -kInfinity};
              for (int k = sz[0]; k <= sz[1]; ++k)
                for (int j = sy[0]; j <= sy[1]; ++j) {
                  const float* v = &values_[std::size_t(k) * stride_[2] + std::size_t(j) * stride_[1]];
                  for (int i = sx[0]; i <= sx[1]; ++i)
                    range[0] = std::min(range[0], v[i]), range[1] = std::max(range[1], v[i]);
                }
              ranges[z * layer + std::size_t(y) * row + std::size_t(x)] = range;
            }
      },
      1);
  return ranges;
}

}  // namespace aureole
