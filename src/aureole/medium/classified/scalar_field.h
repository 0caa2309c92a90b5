// SPDX-License-Identifier: Apache-2.0
// `ScalarField`: the values of a volume on a regular grid, for programs of many lookups along a ray. They
// keep the type of their file, and stay in the mapped file itself where that is neither compressed nor of the
// other byte order.
#pragma once

#include <array>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

#include "aureole/core/unfilled.h"
#include "aureole/math/transform.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Numbers at the centres of size[0] * size[1] * size[2] equal voxels that fill the box [0, 1]^3 of `to_box`, linear
/// along each axis between centres, and constant between the outermost centres and the faces of the box.
class ScalarField {
  using Pair = float __attribute__((vector_size(2 * sizeof(float))));
  using Lanes = float __attribute__((vector_size(4 * sizeof(float))));
  using IntLanes = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));

public:
  /// Takes the numbers that the volume has stored; those of another volume with a box are evaluated at the centres of
  /// its voxels and stored as float32.
  explicit ScalarField(const Volume& volume);
  ScalarField(ScalarField&&) = default;

  const Transform& to_box() const { return to_box_; }
  const std::array<int, 3>& size() const { return size_; }
  /// Smallest distance of two neighbouring centres in the world.
  float spacing() const { return spacing_; }
  /// Number of values that are not finite; the smallest and the largest value are taken over the others.
  std::size_t broken() const { return broken_; }
  float minimum() const { return minimum_; }
  float maximum() const { return maximum_; }
  ScalarType type() const { return type_; }
  /// Bytes of memory for values that are neither in a mapped file nor shared with the volume.
  std::size_t own_bytes() const { return own_.size(); }

  /// Coordinates of a point in the world, in units of voxels: the centre of the first voxel is at 0.
  Vec3 index_of(const Vec3& p) const {
    return {rows_[0][0] * p.x + rows_[0][1] * p.y + rows_[0][2] * p.z + rows_[0][3],
            rows_[1][0] * p.x + rows_[1][1] * p.y + rows_[1][2] * p.z + rows_[1][3],
            rows_[2][0] * p.x + rows_[2][1] * p.y + rows_[2][2] * p.z + rows_[2][3]};
  }
  /// The change of `index_of` along a vector.
  Vec3 index_vector(const Vec3& d) const {
    return {rows_[0][0] * d.x + rows_[0][1] * d.y + rows_[0][2] * d.z,
            rows_[1][0] * d.x + rows_[1][1] * d.y + rows_[1][2] * d.z,
            rows_[2][0] * d.x + rows_[2][1] * d.y + rows_[2][2] * d.z};
  }
  /// The point in world space with these voxel coordinates.
  Vec3 point_of_index(const Vec3& i) const { return from_index_.point(i); }

  float value_at_index(const Vec3& i) const {
    std::ptrdiff_t at;
    Lanes t;
    locate(lanes(i), at, t);
    switch (type_) {
      case ScalarType::float32:
        return interpolated<float>(at, t);
      case ScalarType::uint8:
        return scaled(interpolated<std::uint8_t>(at, t));
      case ScalarType::int16:
        return scaled(interpolated<std::int16_t>(at, t));
      case ScalarType::uint16:
        return scaled(interpolated<std::uint16_t>(at, t));
      default:
        return scaled(interpolated<std::int8_t>(at, t));
    }
  }
  float value(const Vec3& p) const { return value_at_index(index_of(p)); }
  /// The numbers along a ray, stored as T.
  template <class T>
  class Line {
  public:
    Line(const ScalarField& field, const Ray& ray)
        : field_(field), o_(lanes(field.index_of(ray.o))), d_(lanes(field.index_vector(ray.d))) {}
    /// The field's value at a distance from the ray's origin.
    float operator()(float distance) const {
      std::ptrdiff_t at;
      Lanes t;
      field_.locate(o_ + d_ * distance, at, t);
      const float stored = field_.interpolated<T>(at, t);
      if constexpr (std::is_same_v<T, float>)
        return stored;
      else
        return field_.scaled(stored);
    }

  private:
    const ScalarField& field_;
    Lanes o_, d_;  ///< origin and direction of the ray in units of voxels
  };
  /// Returns f(line) with the `Line` of a ray, for loops that are compiled for each type.
  template <class F>
  auto along(const Ray& ray, const F& f) const {
    return with_type([&](auto example) { return f(Line<decltype(example)>(*this, ray)); });
  }
  /// The number of a voxel inside the grid.
  float voxel(int x, int y, int z) const;
  /// Gradient in the world [1/length] by central differences over two voxels, or over one at the border.
  Vec3 gradient(const Vec3& p) const;

  /// Smallest and largest number in each of equal cells of the box and on their faces, x fastest.
  std::vector<std::array<float, 2>> ranges(const std::array<int, 3>& cells) const;

private:
  static Lanes lanes(const Vec3& v) { return Lanes{v.x, v.y, v.z, 0}; }
  /// Finds the cell between voxel centres that holds a point, in units of voxels: the offset of its first voxel and the position
  /// within it along each axis.
  void locate(Lanes i, std::ptrdiff_t& at, Lanes& t) const {
    i = i > 0 ? i : Lanes{};  // A NaN coordinate becomes 0.
    i = i < last_ ? i : last_;
    IntLanes cell = __builtin_convertvector(i, IntLanes);
    cell = cell < last_cell_ ? cell : last_cell_;
    t = i - __builtin_convertvector(cell, Lanes);
    at = cell[0] * stride_[0] + cell[1] * stride_[1] + cell[2] * stride_[2];
  }
  /// The stored value at an offset, counted in values; it need not be aligned.
  template <class T>
  float loaded(std::ptrdiff_t at) const {
    T number;
    std::memcpy(&number, numbers_ + at * std::ptrdiff_t(sizeof(T)), sizeof(T));
    return float(number);
  }
  /// Two stored values that lie `stride_[0]` apart, in lanes 0 and 1.
  template <class T>
  Pair loaded_pair(std::ptrdiff_t at) const {
    if (stride_[0] != 1) return Pair{loaded<T>(at), loaded<T>(at + stride_[0])};
    T numbers[2];
    std::memcpy(numbers, numbers_ + at * std::ptrdiff_t(sizeof(T)), sizeof(numbers));
    return Pair{float(numbers[0]), float(numbers[1])};
  }
  template <class T>
  float interpolated(std::ptrdiff_t at, const Lanes& t) const {
    const Pair near = loaded_pair<T>(at), near_above = loaded_pair<T>(at + stride_[1]),
               far = loaded_pair<T>(at + stride_[2]),
               far_above = loaded_pair<T>(at + stride_[1] + stride_[2]);
    const Pair below = near + t[2] * (far - near), above = near_above + t[2] * (far_above - near_above);
    const Pair row = below + t[1] * (above - below);
    return row[0] + t[0] * (row[1] - row[0]);
  }
  float scaled(float stored) const {
    return is_scaled_ ? float(slope_ * double(stored) + intercept_) : stored;
  }
  /// Calls f with a number of the type in which the numbers are stored.
  template <class F>
  auto with_type(const F& f) const {
    switch (type_) {
      case ScalarType::float32:
        return f(float());
      case ScalarType::uint8:
        return f(std::uint8_t());
      case ScalarType::int16:
        return f(std::int16_t());
      case ScalarType::uint16:
        return f(std::uint16_t());
      default:
        return f(std::int8_t());
    }
  }
  void evaluate(const Volume& volume);
  void take(const std::shared_ptr<const ScalarGrid>& grid);
  template <class T>
  void find_ranges(const std::array<int, 3>& cells, std::vector<std::array<float, 2>>& ranges) const;
  Vec3 to_world_gradient(const Vec3& g) const;

  Transform to_box_, from_index_;
  std::array<int, 3> size_;
  Lanes last_{};               ///< index of the last centre, of an axis of at least two
  IntLanes last_cell_{};       ///< index of the last cell between two centres
  std::array<int, 3> padded_;  ///< as `size_`, but at least two: a single layer is read twice
  /// distance between neighbours along each axis, counted in values; 0 along an axis of one layer
  std::ptrdiff_t stride_[3];
  float rows_[3][4];
  float spacing_ = 0, minimum_ = 0, maximum_ = 0;
  std::size_t broken_ = 0;
  /// type of the stored values: float32, or an integer of at most two bytes
  ScalarType type_ = ScalarType::float32;
  const std::byte* numbers_ = nullptr;
  bool is_scaled_ = false;
  double slope_ = 1, intercept_ = 0;  ///< value = slope * stored number + intercept
  std::shared_ptr<const ScalarGrid> stored_;
  UnfilledVector<std::byte> own_;
};

}  // namespace aureole
