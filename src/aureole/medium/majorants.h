// SPDX-License-Identifier: Apache-2.0
// `Majorants`: upper bounds of a medium's density, whatever structure holds them. Another structure (an
// octree, splats) is one more alternative here, and transport does not change.
#pragma once

#include "aureole/medium/majorant_grid.h"

namespace aureole {

/// A part of a ray in which one bound holds.
using MajorantSegment = MajorantGrid::Piece;

class Majorants {
public:
  /// The density is 1 everywhere.
  Majorants() = default;
  /// The bounds of a grid, which must outlive this object; the density is 0 outside of it.
  explicit Majorants(const MajorantGrid& grid) : grid_(&grid) {}

  /// Returns the grid of bounds; null if the density is 1 everywhere.
  const MajorantGrid* grid() const { return grid_; }
  /// Whether the density varies.
  explicit operator bool() const { return grid_ != nullptr; }
  /// The bound at a point of the world.
  float bound_at(const Vec3& p) const { return grid_ ? grid_->at(p) : 1.f; }
  /// The largest bound.
  float max_bound() const { return grid_ ? grid_->maximum() : 1.f; }

  /// The transform from the world to the box [0, 1]^3, outside of which the density is 0. Only for a density
  /// that varies.
  const Transform& to_box() const { return grid_->to_box(); }
  const std::array<int, 3>& cells() const { return grid_->cells(); }

  /// Calls visit(segment) for the segments of a ray of unit direction from its origin to the distance t_max,
  /// in order, until `visit` returns true; segments with a bound of 0 are left out. Returns whether `visit`
  /// has returned true.
  template <class Visit>
  bool visit_segments(const Ray& ray, float t_max, Visit&& visit) const {
    if (!grid_) return visit(MajorantSegment{0, t_max, 1});
    MajorantGrid::Walk walk(*grid_, ray, t_max);
    MajorantSegment segment;
    while (walk.next(segment))
      if (visit(segment)) return true;
    return false;
  }

private:
  const MajorantGrid* grid_ = nullptr;  ///< grid of bounds; null: the density is 1 everywhere
};

}  // namespace aureole
