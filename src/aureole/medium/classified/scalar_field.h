// SPDX-License-Identifier: Apache-2.0
// `ScalarField`: the numbers of a volume on a regular grid of its own, for programs of many lookups along a ray.
#pragma once

#include <array>
#include <vector>

#include "aureole/math/transform.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Numbers at the centres of size[0] * size[1] * size[2] equal voxels that fill the box [0, 1]^3 of `to_box`, linear
/// along each axis between centres, and constant between the outermost centres and the faces of the box.
class ScalarField {
public:
  /// Evaluates a volume with a box at the centres of its voxels.
  explicit ScalarField(const Volume& volume);

  const Transform& to_box() const { return to_box_; }
  const std::array<int, 3>& size() const { return size_; }
  /// Smallest distance of two neighbouring centres in the world.
  float spacing() const { return spacing_; }
  /// How many numbers are not finite; smallest and largest number are those of the others.
  std::size_t broken() const { return broken_; }
  float minimum() const { return minimum_; }
  float maximum() const { return maximum_; }

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

  float value_at_index(const Vec3& i) const {
    std::size_t at;
    float t[3];
    locate(i, at, t);
    const float* v = values_.data() + at;
    const auto mix = [](float a, float b, float s) { return a + s * (b - a); };
    const float* w = v + stride_[2];
    const float below = mix(mix(v[0], v[1], t[0]), mix(v[stride_[1]], v[stride_[1] + 1], t[0]), t[1]);
    const float above = mix(mix(w[0], w[1], t[0]), mix(w[stride_[1]], w[stride_[1] + 1], t[0]), t[1]);
    return mix(below, above, t[2]);
  }
  float value(const Vec3& p) const { return value_at_index(index_of(p)); }
  /// Gradient in the world [1/length] by central differences over two voxels, or over one at the border.
  Vec3 gradient(const Vec3& p) const;

  /// Smallest and largest number in each of equal cells of the box and on their faces, x fastest.
  std::vector<std::array<float, 2>> ranges(const std::array<int, 3>& cells) const;

private:
  void locate(const Vec3& i, std::size_t& at, float t[3]) const {
    at = 0;
    for (int k = 0; k < 3; ++k) {
      // A NaN becomes 0.
      const float last = float(padded_[std::size_t(k)] - 2);
      const float c = i[k] > 0 ? (i[k] < last + 1 ? i[k] : last + 1) : 0.f;
      const int cell = c < last ? int(c) : padded_[std::size_t(k)] - 2;
      t[k] = c - float(cell);
      at += std::size_t(cell) * stride_[k];
    }
  }
  Vec3 to_world_gradient(const Vec3& g) const;

  Transform to_box_;
  std::array<int, 3> size_;
  std::array<int, 3> padded_;  ///< as `size_`, but at least two: a single layer is stored twice
  std::size_t stride_[3];
  float rows_[3][4];
  float spacing_ = 0, minimum_ = 0, maximum_ = 0;
  std::size_t broken_ = 0;
  std::vector<float> values_;
};

}  // namespace aureole
