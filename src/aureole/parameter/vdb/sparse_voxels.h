// SPDX-License-Identifier: Apache-2.0
// `SparseVoxels`: a grid of OpenVDB or NanoVDB without the types of these libraries.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace aureole {

struct SparseVoxels {
  static constexpr int kEdge = 8;  ///< edge of a block, in voxels
  static constexpr std::size_t kBlockVoxels = std::size_t(kEdge) * kEdge * kEdge;

  using Coordinates = std::array<int, 3>;
  /// One value for all voxels from `lower` to `upper`; `lower` and `upper` + 1 are multiples of kEdge.
  struct Tile {
    Coordinates lower, upper;
    std::array<float, 3> value;
  };

  std::string name;
  int channels = 1;  ///< numbers of a voxel: 1 or 3
  /// Transform to the grid's space from coordinates that are integers at the voxels' centres; row-major, for
  /// column vectors.
  std::array<std::array<double, 4>, 4> to_space{};
  std::array<float, 3> background{};  ///< value outside tiles and blocks
  std::vector<Tile> tiles;
  std::vector<Coordinates> blocks;  ///< lowest voxel of each block, multiples of kEdge
  std::vector<float> values;        ///< values of the blocks: channels of a voxel, then x, y, z
  Coordinates lower{}, upper{};     ///< bounds of the active voxels
  bool empty = true;                ///< whether there are no active voxels

  void extend(const Coordinates& least, const Coordinates& most) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = empty || least[i] < lower[i] ? least[i] : lower[i];
      upper[i] = empty || most[i] > upper[i] ? most[i] : upper[i];
    }
    empty = false;
  }
};

/// Adds a leaf of OpenVDB or NanoVDB, in which z is fastest. For the i-th voxel, `is_active(i)` returns
/// whether it is active and `value(i)` its channels.
template <class IsActive, class Value>
void add_block(SparseVoxels& voxels, const SparseVoxels::Coordinates& origin, const IsActive& is_active,
               const Value& value) {
  constexpr int n = SparseVoxels::kEdge;
  bool any = false;
  SparseVoxels::Coordinates least{n, n, n}, most{-1, -1, -1};
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) {
        if (!is_active((x * n + y) * n + z)) continue;
        any = true;
        const SparseVoxels::Coordinates at{x, y, z};
        for (std::size_t i = 0; i < 3; ++i) {
          if (at[i] < least[i]) least[i] = at[i];
          if (at[i] > most[i]) most[i] = at[i];
        }
      }
  if (!any) return;
  for (std::size_t i = 0; i < 3; ++i) least[i] += origin[i], most[i] += origin[i];
  voxels.extend(least, most);
  voxels.blocks.push_back(origin);
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const std::array<float, 3> v = value((x * n + y) * n + z);
        voxels.values.insert(voxels.values.end(), v.begin(), v.begin() + voxels.channels);
      }
}

/// The result of reading one grid from a file.
struct SparseFile {
  std::string error;               ///< error of the file, if it cannot be read
  std::vector<std::string> grids;  ///< names of all grids in the file
  bool found = false;              ///< whether the requested grid is among them
  SparseVoxels voxels;             ///< the requested grid
};

/// Returns the grid that is read if no name is given: "density", or else the first.
inline std::size_t default_grid(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == "density") return i;
  return 0;
}

}  // namespace aureole
