// SPDX-License-Identifier: Apache-2.0
// `RadianceField`: a sparse grid of density and colour by direction in the world, interpolated trilinearly.
#pragma once

#include <memory>
#include <optional>

#include "aureole/math/transform.h"
#include "aureole/medium/majorant_grid.h"
#include "aureole/parameter/radiance/radiance_voxels.h"

namespace aureole {

class RadianceField {
public:
  /// `to_world` places the grid. Lengths along a ray are those of the grid, so that a picture does not change when camera
  /// and grid are scaled together; `scale` is a factor of the density.
  RadianceField(std::shared_ptr<const RadianceVoxels> voxels, const Transform& to_world, float scale);

  /// Coordinates of the grid: the centres of voxels are at integers from 0 to size - 1, and the box ends 1/2 beyond them.
  Vec3 index_of(const Vec3& world) const { return to_index_.point(world); }
  Vec3 index_vector(const Vec3& world) const { return to_index_.vector(world); }
  /// Extinction in the world [1/length] of the density 1, for light along `d`, of unit length.
  float extinction_along(const Vec3& d) const { return scale_ * length(to_file_.vector(d)); }

  /// The harmonics of a direction in which a camera looks.
  struct View {
    float functions[16];
  };
  View view_along(const Vec3& d) const;

  /// The eight voxels around a point, with their weights; beyond the outermost centres the numbers continue.
  struct Cell {
    std::int32_t links[8];
    float weights[8];
  };
  /// Finds them. Returns false outside of the box, and where all eight are empty.
  bool find_cell(const Vec3& index, Cell& cell) const;
  /// Interpolated density before negative values count as 0.
  float raw_density(const Cell& cell) const;
  float density(const Vec3& index) const {
    Cell cell;
    return find_cell(index, cell) ? std::max(0.f, raw_density(cell)) : 0.f;
  }
  /// Interpolated colour before negative values count as 0.
  Vec3 raw_color(const Cell& cell, const View& view) const;

  /// Distances at which a ray enters and leaves the box; nothing where it does not pass it or begins behind it.
  std::optional<std::array<float, 2>> cross_box(const Ray& ray) const;

  const RadianceVoxels& voxels() const { return *voxels_; }
  /// Upper bounds of the density. A cell lies between eight centres; those at the border reach 1 beyond the outermost.
  const MajorantGrid& grid() const { return *grid_; }
  /// The shortest edge of a voxel in the world.
  float voxel_edge() const { return voxel_edge_; }

private:
  std::shared_ptr<const RadianceVoxels> voxels_;
  Transform to_file_, to_index_, turn_;  ///< from the world; `turn_` is its rotation alone
  float scale_, voxel_edge_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole
