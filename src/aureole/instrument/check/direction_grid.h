// SPDX-License-Identifier: Apache-2.0
// Fixed bins and points over all directions, for functions with jumps, such as the edge of a lamp, and for
// integrals of smooth ones. direction_bins.h has bins that adapt to a density.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Bins of equal solid angle: `rows` of equal height in z, from +z on, of `columns` in azimuth.
class DirectionGrid {
public:
  DirectionGrid(int rows, int columns) : rows_(rows), columns_(columns) {}
  std::size_t size() const { return std::size_t(rows_) * std::size_t(columns_); }
  std::size_t find(const Vec3& direction) const;
  /// The integral of a density [1/sr] over each bin, by the midpoint rule with `fine` x `fine` points in
  /// each.
  std::vector<double> integrate(const std::function<double(const Vec3&)>& density, int fine) const;

private:
  int rows_, columns_;
};

/// Direction k of n that cover the sphere evenly, each for 4 pi/n sr: a Fibonacci lattice.
Vec3 fibonacci_direction(int k, int n);

}  // namespace aureole
