// SPDX-License-Identifier: Apache-2.0
// `BrickGrid`: values on a regular grid, stored in bricks of 8 x 8 x 8 voxels. Each brick repeats the first
// layer of its neighbours, so that the eight corners of an interpolation are in one brick at fixed offsets.
// Border bricks repeat the values beyond the border, so that lookups have no branches. Bricks of one value
// are stored once per value: an empty part of a sparse grid takes four bytes per 512 voxels. Compared with a
// plain array, lookups take a fifth longer at 128^3 voxels and a tenth less at 256^3
// (bench/volume_bench.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

template <class T>
class BrickGrid {
public:
  static constexpr int kEdge = 8;

  BrickGrid() = default;

  /// `fetch(x, y, z)` returns the value of a voxel inside the grid. `uniform(lower, upper)` returns the value
  /// of all voxels in [lower, upper] if they are known to be equal, else nothing. Beyond its borders the grid
  /// is repeated, or its border values continue. Throws Error if the bricks exceed an index of 32 bits.
  template <class Fetch, class Uniform>
  BrickGrid(const std::array<int, 3>& size, bool repeat, const Fetch& fetch, const Uniform& uniform)
      : size_(size), repeat_(repeat) {
    std::size_t count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      // The lower corner of an interpolation is one of -1, ..., size - 1.
      bricks_[i] = (size[i] + kEdge) / kEdge;
      extent_[i] = std::min(kEdge + 1, size[i] + 2);
      if (std::size_t(bricks_[i]) > kMaxBricks / count) throw Error("has more voxels than can be indexed");
      count *= std::size_t(bricks_[i]);
    }
    stride_y_ = extent_[0], stride_z_ = extent_[0] * extent_[1];
    brick_size_ = std::size_t(stride_z_) * std::size_t(extent_[2]);
    index_.reserve(count);
    std::vector<T> brick(brick_size_);
    std::array<int, 3> at;
    for (at[2] = 0; at[2] < bricks_[2]; ++at[2])
      for (at[1] = 0; at[1] < bricks_[1]; ++at[1])
        for (at[0] = 0; at[0] < bricks_[0]; ++at[0]) add_brick(at, fetch, uniform, brick);
    values_.shrink_to_fit();
  }

  bool empty() const { return index_.empty(); }
  const std::array<int, 3>& size() const { return size_; }
  std::size_t memory_bytes() const {
    return values_.size() * sizeof(T) + index_.size() * sizeof(std::uint32_t);
  }

  /// Returns the value of a voxel in [-1, size - 1]; its upper neighbours are at offsets 1, stride_y() and
  /// stride_z().
  const T* corner(int x, int y, int z) const {
    const unsigned sx = unsigned(x + 1), sy = unsigned(y + 1), sz = unsigned(z + 1);
    const std::size_t brick =
        (std::size_t(sz / kEdge) * std::size_t(bricks_[1]) + sy / kEdge) * std::size_t(bricks_[0]) +
        sx / kEdge;
    return values_.data() + std::size_t(index_[brick]) * brick_size_ +
           (sz % kEdge * unsigned(stride_z_) + sy % kEdge * unsigned(stride_y_) + sx % kEdge);
  }
  std::ptrdiff_t stride_y() const { return stride_y_; }
  std::ptrdiff_t stride_z() const { return stride_z_; }

  /// Calls visit(value) for the values of the voxels from spans[i][0] to spans[i][1] along each axis, within
  /// [-1, size]. A brick with one value is visited once.
  template <class Visit>
  void for_each_in(const std::array<std::array<int, 2>, 3>& spans, const Visit& visit) const {
    std::array<int, 3> first, last, at;
    for (std::size_t i = 0; i < 3; ++i) {
      last[i] = std::min((spans[i][1] + 1) / kEdge, bricks_[i] - 1);
      first[i] = std::min((spans[i][0] + 1) / kEdge, last[i]);
    }
    for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
        for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) {
          std::array<int, 3> from, to;
          for (std::size_t i = 0; i < 3; ++i) {
            from[i] = std::max(spans[i][0], at[i] * kEdge - 1);
            // Voxels on the last brick's border belong to that brick alone.
            to[i] = at[i] == last[i] ? spans[i][1] : at[i] * kEdge + kEdge - 2;
          }
          const T* v = values_.data() + std::size_t(index_[brick_number(at)]) * brick_size_;
          if (is_uniform_[index_[brick_number(at)]]) {
            visit(*v);
            continue;
          }
          v += (from[2] + 1 - at[2] * kEdge) * stride_z_ + (from[1] + 1 - at[1] * kEdge) * stride_y_ +
               (from[0] + 1 - at[0] * kEdge);
          for (int z = 0; z <= to[2] - from[2]; ++z)
            for (int y = 0; y <= to[1] - from[1]; ++y)
              for (int x = 0; x <= to[0] - from[0]; ++x) visit(v[z * stride_z_ + y * stride_y_ + x]);
        }
  }

  /// Calls visit(value) for all stored values; copies of border voxels are included.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const T& v : values_) visit(v);
  }

private:
  static constexpr std::size_t kMaxBricks = 150000000;  // 600 MB of indices
  static constexpr std::size_t kMaxUniform = 64;

  template <class Fetch, class Uniform>
  void add_brick(const std::array<int, 3>& at, const Fetch& fetch, const Uniform& uniform,
                 std::vector<T>& brick) {
    std::array<int, 3> from, to;  // range without wrapping
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = at[i] * kEdge - 1, to[i] = std::min(from[i] + extent_[i] - 1, size_[i]);
      inside &= from[i] >= 0 && to[i] < size_[i];
      if (!repeat_) from[i] = std::max(from[i], 0), to[i] = std::min(to[i], size_[i] - 1);
    }
    std::optional<T> one;
    if (inside || !repeat_) one = uniform(from, to);
    if (!one) {
      T* out = brick.data();
      for (int z = 0; z < extent_[2]; ++z)
        for (int y = 0; y < extent_[1]; ++y)
          for (int x = 0; x < extent_[0]; ++x)
            *out++ = fetch(wrapped(at[0] * kEdge - 1 + x, 0), wrapped(at[1] * kEdge - 1 + y, 1),
                           wrapped(at[2] * kEdge - 1 + z, 2));
      if (std::all_of(brick.begin(), brick.end(), [&](const T& v) { return v == brick[0]; })) one = brick[0];
    }
    if (one) {
      const auto known =
          std::find_if(known_.begin(), known_.end(), [&](const auto& k) { return k.first == *one; });
      if (known != known_.end()) {
        index_.push_back(known->second);
        std::swap(*known, known_.front());  // its neighbours probably have this value, too
        return;
      }
      std::fill(brick.begin(), brick.end(), *one);
      if (known_.size() < kMaxUniform)
        known_.insert(known_.begin(), {*one, std::uint32_t(is_uniform_.size())});
    }
    index_.push_back(std::uint32_t(is_uniform_.size()));
    is_uniform_.push_back(one.has_value());
    values_.insert(values_.end(), brick.begin(), brick.end());
  }

  /// Returns the voxel inside the grid that replaces a voxel at or beyond its border.
  int wrapped(int i, std::size_t axis) const {
    const int n = size_[axis];
    if (repeat_) return i < 0 ? n - 1 : i % n;
    return std::clamp(i, 0, n - 1);
  }
  std::size_t brick_number(const std::array<int, 3>& at) const {
    return (std::size_t(at[2]) * std::size_t(bricks_[1]) + std::size_t(at[1])) * std::size_t(bricks_[0]) +
           std::size_t(at[0]);
  }

  std::array<int, 3> size_{}, bricks_{};
  std::array<int, 3> extent_{};  ///< size of a brick: kEdge + 1, or less in a grid of one brick
  bool repeat_ = false;
  int stride_y_ = 0, stride_z_ = 0;
  std::size_t brick_size_ = 0;
  std::vector<std::uint32_t> index_;                ///< index of each brick's values
  std::vector<T> values_;                           ///< values of all stored bricks
  std::vector<bool> is_uniform_;                    ///< whether a stored brick has one value
  std::vector<std::pair<T, std::uint32_t>> known_;  ///< stored bricks with one value
};

}  // namespace aureole
