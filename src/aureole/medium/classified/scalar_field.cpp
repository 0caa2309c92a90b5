// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/scalar_field.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {

ScalarField::ScalarField(const Volume& volume)
    : to_box_(volume.to_box().value_or(Transform())), size_(volume.resolution()) {
  for (std::size_t k = 0; k < 3; ++k) {
    padded_[k] = std::max(size_[k], 2);
    last_[k] = float(padded_[k] - 1), last_cell_[k] = padded_[k] - 2;
  }
  const auto& m = to_box_.matrix();
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) rows_[r][c] = float(m[r][c] * size_[r] - (c == 3 ? 0.5 : 0.0));
  const Transform from_box = to_box_.inverse();
  from_index_ = from_box * Transform::scale(1. / size_[0], 1. / size_[1], 1. / size_[2]) *
                Transform::translate(.5, .5, .5);
  spacing_ = kInfinity;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k)
    spacing_ = std::min(spacing_, length(from_box.vector(axes[k])) / float(size_[std::size_t(k)]));
  if (const auto grid = volume.stored_grid()) {
    take(grid);
    minimum_ = volume.minimum(), maximum_ = volume.maximum();
  } else {
    evaluate(volume);
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (size_[k] == 1) stride_[k] = 0;
}

void ScalarField::evaluate(const Volume& volume) {
  const Transform from_box = to_box_.inverse();
  stride_[0] = 1, stride_[1] = size_[0], stride_[2] = std::ptrdiff_t(size_[0]) * size_[1];
  own_.resize(std::size_t(stride_[2]) * std::size_t(size_[2]) * sizeof(float));
  numbers_ = own_.data();
  float* const values = reinterpret_cast<float*>(own_.data());
  for_ranges(
      std::size_t(size_[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t z = begin; z < end; ++z)
          for (int y = 0; y < size_[1]; ++y)
            for (int x = 0; x < size_[0]; ++x) {
              const auto centre = [&](int i, std::size_t k) { return (float(i) + 0.5f) / float(size_[k]); };
              values[std::ptrdiff_t(z) * stride_[2] + y * stride_[1] + x] =
                  volume.eval_scalar(from_box.point({centre(x, 0), centre(y, 1), centre(int(z), 2)}));
            }
      },
      1);
  minimum_ = kInfinity, maximum_ = -kInfinity;
  for (std::size_t i = 0; i < own_.size() / sizeof(float); ++i) {
    broken_ += !std::isfinite(values[i]);
    minimum_ = std::min(minimum_, values[i]), maximum_ = std::max(maximum_, values[i]);
  }
}

void ScalarField::take(const std::shared_ptr<const ScalarGrid>& grid) {
  const bool is_kept = grid->type == ScalarType::float32 || bytes_of(grid->type) == 1 ||
                       grid->type == ScalarType::int16 || grid->type == ScalarType::uint16;
  const bool is_scaled = grid->slope != 1 || grid->intercept != 0;
  if (is_kept && !grid->is_swapped && !(is_scaled && grid->type == ScalarType::float32)) {
    type_ = grid->type;
    numbers_ = grid->numbers.bytes.data();
    for (std::size_t k = 0; k < 3; ++k) stride_[k] = grid->strides[k];
    slope_ = grid->slope, intercept_ = grid->intercept, is_scaled_ = is_scaled;
    stored_ = grid;
    return;
  }
  // Values of other types become float32; values of the other byte order keep their type.
  const bool is_converted = !is_kept || grid->type == ScalarType::float32;
  type_ = is_converted ? ScalarType::float32 : grid->type;
  if (!is_converted) slope_ = grid->slope, intercept_ = grid->intercept, is_scaled_ = is_scaled;
  stride_[0] = 1, stride_[1] = size_[0], stride_[2] = std::ptrdiff_t(size_[0]) * size_[1];
  const std::size_t bytes = bytes_of(type_), row = std::size_t(size_[0]) * bytes;
  own_.resize(std::size_t(stride_[2]) * std::size_t(size_[2]) * bytes);
  numbers_ = own_.data();
  for_ranges(
      std::size_t(size_[1]) * std::size_t(size_[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const int y = int(i % std::size_t(size_[1])), z = int(i / std::size_t(size_[1]));
          std::byte* const out = own_.data() + i * row;
          if (is_converted) {
            grid->read_row(0, y, z, 0, {reinterpret_cast<float*>(out), std::size_t(size_[0])});
            continue;
          }
          for (int x = 0; x < size_[0]; ++x) {
            const std::byte* const from =
                grid->numbers.bytes.data() +
                std::ptrdiff_t(bytes) * (x * grid->strides[0] + y * grid->strides[1] + z * grid->strides[2]);
            std::reverse_copy(from, from + bytes, out + std::size_t(x) * bytes);
          }
        }
      },
      64);
}

float ScalarField::voxel(int x, int y, int z) const {
  const std::ptrdiff_t at = x * stride_[0] + y * stride_[1] + z * stride_[2];
  return with_type([&](auto example) { return scaled(loaded<decltype(example)>(at)); });
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

template <class T>
void ScalarField::find_ranges(const std::array<int, 3>& cells,
                              std::vector<std::array<float, 2>>& ranges) const {
  const std::size_t row = std::size_t(cells[0]), layer = row * std::size_t(cells[1]);
  const auto span = [&](int cell, std::size_t k) {
    const double step = double(size_[k]) / cells[k];
    // Interpolation within a cell uses the voxels up to half a voxel beyond its faces; the small part is for rounding.
    return std::array{std::clamp(int(std::floor(cell * step - 0.5 - 1e-3)), 0, size_[k] - 1),
                      std::clamp(int(std::ceil((cell + 1) * step - 0.5 + 1e-3)), 0, size_[k] - 1)};
  };
  const std::size_t nx = std::size_t(size_[0]);
  for_ranges(
      std::size_t(cells[1]) * std::size_t(cells[2]),
      [&](std::size_t begin, std::size_t end) {
        // Minima and maxima over the rows of voxels that a row of cells uses, in a form that the compiler
        // vectorises.
        std::vector<T> low(nx), high(nx);
        for (std::size_t i = begin; i < end; ++i) {
          const auto sy = span(int(i % std::size_t(cells[1])), 1),
                     sz = span(int(i / std::size_t(cells[1])), 2);
          std::fill(low.begin(), low.end(), std::numeric_limits<T>::max());
          std::fill(high.begin(), high.end(), std::numeric_limits<T>::lowest());
          for (int k = sz[0]; k <= sz[1]; ++k)
            for (int j = sy[0]; j <= sy[1]; ++j) {
              const std::byte* v = numbers_ + (k * stride_[2] + j * stride_[1]) * std::ptrdiff_t(sizeof(T));
              const auto add = [&](std::ptrdiff_t step) {
                for (std::size_t x = 0; x < nx; ++x) {
                  T number;
                  std::memcpy(&number, v + std::ptrdiff_t(x) * step, sizeof(T));
                  low[x] = number < low[x] ? number : low[x], high[x] = number > high[x] ? number : high[x];
                }
              };
              if (stride_[0] == 1)
                add(sizeof(T));  // A constant step lets the compiler vectorise the loop.
              else
                add(stride_[0] * std::ptrdiff_t(sizeof(T)));
            }
          for (int x = 0; x < cells[0]; ++x) {
            const auto sx = span(x, 0);
            const auto first = std::ptrdiff_t(sx[0]), last = std::ptrdiff_t(sx[1]) + 1;
            const float a = scaled(float(*std::min_element(low.begin() + first, low.begin() + last))),
                        b = scaled(float(*std::max_element(high.begin() + first, high.begin() + last)));
            ranges[i / std::size_t(cells[1]) * layer + i % std::size_t(cells[1]) * row + std::size_t(x)] = {
                std::min(a, b), std::max(a, b)};
          }
        }
      },
      16);
}

std::vector<std::array<float, 2>> ScalarField::ranges(const std::array<int, 3>& cells) const {
  std::vector<std::array<float, 2>> ranges(std::size_t(cells[0]) * std::size_t(cells[1]) *
                                           std::size_t(cells[2]));
  with_type([&](auto example) { find_ranges<decltype(example)>(cells, ranges); });
  return ranges;
}

}  // namespace aureole
