// SPDX-License-Identifier: Apache-2.0
// Fixed bins and points over all directions, for functions with discontinuities, such as the edge of a light
// source, and for integrals of smooth functions. direction_bins.h has bins that adapt to a pdf.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Bins of equal solid angle: `rows` of equal height in z, starting at +z, times `columns` in azimuth.
class DirectionGrid {
public:
  DirectionGrid(int rows, int columns) : rows_(rows), columns_(columns) {}
  std::size_t size() const { return std::size_t(rows_) * std::size_t(columns_); }
  std::size_t find(const Vec3& direction) const;
  /// The integral of a pdf [1/sr] over each bin, by the midpoint rule with `fine` x `fine` points per bin.
  std::vector<double> integrate(const std::function<double(const Vec3&)>& density, int fine) const;

private:
  int rows_, columns_;
};

/// Direction k of n directions that cover the sphere uniformly, each representing 4 pi/n sr: a Fibonacci
/// lattice.
Vec3 fibonacci_direction(int k, int n);

}  // namespace aureole
