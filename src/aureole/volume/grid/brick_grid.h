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
#include "aureole/core/parallel.h"
#include "aureole/core/unfilled.h"

namespace aureole {

template <class T>
class BrickGrid {
public:
  static constexpr int kEdge = 8;

  BrickGrid() = default;

  /// `fetch(x, y, z)` returns the value of a voxel inside the grid. `uniform(lower, upper)` returns the value
  /// of all voxels in [lower, upper] if they are known to be equal, else nothing. Beyond its borders the grid
  /// is repeated, or its border values continue. Both are called by several threads, `fetch` up to three times for a
  /// voxel of a brick. Throws Error if the bricks exceed an index of 32 bits.
  template <class Fetch, class Uniform>
  BrickGrid(const std::array<int, 3>& size, bool repeat, const Fetch& fetch, const Uniform& uniform)
      : size_(size), repeat_(repeat) {
    std::size_t count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      // Index -1, ..., size - 1 of the lower corner of an interpolation.
      bricks_[i] = (size[i] + kEdge) / kEdge;
      extent_[i] = std::min(kEdge + 1, size[i] + 2);
      if (std::size_t(bricks_[i]) > kMaxBricks / count) throw Error("has more voxels than can be indexed");
      count *= std::size_t(bricks_[i]);
    }
    stride_y_ = extent_[0], stride_z_ = extent_[0] * extent_[1];
    brick_size_ = std::size_t(stride_z_) * std::size_t(extent_[2]);
    const auto brick_at = [&](std::size_t b) {
      const std::size_t nx = std::size_t(bricks_[0]), ny = std::size_t(bricks_[1]);
      return std::array{int(b % nx), int(b / nx % ny), int(b / nx / ny)};
    };
    // All cores search for bricks of one value, one core numbers the bricks, and all cores write them.
    std::vector<std::uint8_t> has_one_value(count);
    constexpr std::size_t kAtOnce = 64;
    for_ranges(
        count,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t b = begin; b < end; ++b)
            has_one_value[b] = is_constant(brick_at(b), fetch, uniform);
        },
        kAtOnce);
    index_.reserve(count);
    std::vector<std::uint32_t> brick_of;  // index of the first brick that each stored brick represents
    for (std::size_t b = 0; b < count; ++b) add_brick(b, brick_at(b), has_one_value[b], fetch, brick_of);
    values_.resize(brick_of.size() * brick_size_);
    for_ranges(
        brick_of.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            T* const out = values_.data() + i * brick_size_;
            const std::array<int, 3> at = brick_at(brick_of[i]);
            if (is_uniform_[i])
              std::fill(out, out + brick_size_, first_value(at, fetch));
            else
              write_brick(at, fetch, out);
          }
        },
        kAtOnce);
    known_ = {};
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
            // Voxels on the last brick's border belong to no other brick.
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
  // upper bound of the number of bricks: 600 MB of indices
  static constexpr std::size_t kMaxBricks = 150000000;
  static constexpr std::size_t kMaxUniform = 64;

  /// Calls f(value) for the values of a brick, x fastest, until it returns false.
  template <class Fetch, class F>
  void each_value(const std::array<int, 3>& at, const Fetch& fetch, const F& f) const {
    for (int z = 0; z < extent_[2]; ++z)
      for (int y = 0; y < extent_[1]; ++y)
        for (int x = 0; x < extent_[0]; ++x)
          if (!f(fetch(wrapped(at[0] * kEdge - 1 + x, 0), wrapped(at[1] * kEdge - 1 + y, 1),
                       wrapped(at[2] * kEdge - 1 + z, 2))))
            return;
  }
  template <class Fetch>
  T first_value(const std::array<int, 3>& at, const Fetch& fetch) const {
    return fetch(wrapped(at[0] * kEdge - 1, 0), wrapped(at[1] * kEdge - 1, 1), wrapped(at[2] * kEdge - 1, 2));
  }
  template <class Fetch>
  void write_brick(const std::array<int, 3>& at, const Fetch& fetch, T* out) const {
    each_value(at, fetch, [&](const T& v) {
      *out++ = v;
      return true;
    });
  }

  template <class Fetch, class Uniform>
  bool is_constant(const std::array<int, 3>& at, const Fetch& fetch, const Uniform& uniform) const {
    std::array<int, 3> from, to;  // range of voxels that lies inside the grid, without wrapping
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = at[i] * kEdge - 1, to[i] = std::min(from[i] + extent_[i] - 1, size_[i]);
      inside &= from[i] >= 0 && to[i] < size_[i];
      if (!repeat_) from[i] = std::max(from[i], 0), to[i] = std::min(to[i], size_[i] - 1);
    }
    if ((inside || !repeat_) && uniform(from, to)) return true;
    std::optional<T> first;
    bool is_same = true;
    each_value(at, fetch, [&](const T& v) {
      if (!first) first = v;
      return is_same = v == *first;
    });
    return is_same;
  }

  /// Gives brick number `b` the index of a stored brick, of which a new one is made unless one with this value exists.
  template <class Fetch>
  void add_brick(std::size_t b, const std::array<int, 3>& at, bool has_one_value, const Fetch& fetch,
                 std::vector<std::uint32_t>& brick_of) {
    if (has_one_value) {
      const T one = first_value(at, fetch);
      const auto known =
          std::find_if(known_.begin(), known_.end(), [&](const auto& k) { return k.first == one; });
      if (known != known_.end()) {
        index_.push_back(known->second);
        std::swap(*known, known_.front());  // the neighbouring bricks probably have this value as well
        return;
      }
      if (known_.size() < kMaxUniform)
        known_.insert(known_.begin(), {one, std::uint32_t(is_uniform_.size())});
    }
    index_.push_back(std::uint32_t(is_uniform_.size()));
    is_uniform_.push_back(has_one_value);
    brick_of.push_back(std::uint32_t(b));
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
  UnfilledVector<T> values_;                        ///< values of all stored bricks
  std::vector<bool> is_uniform_;                    ///< whether a stored brick has one value
  std::vector<std::pair<T, std::uint32_t>> known_;  ///< stored bricks with one value
};

}  // namespace aureole
