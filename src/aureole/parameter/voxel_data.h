// SPDX-License-Identifier: Apache-2.0
// `VoxelData`: the numbers of a dense grid, read from a file or given by a program.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "aureole/plugin/array.h"
#include "aureole/plugin/properties.h"

namespace aureole {

struct VoxelData {
  std::array<int, 3> size{};             ///< number of voxels along x, y, z
  int channels = 1;                      ///< numbers per voxel
  std::array<double, 3> lower{0, 0, 0};  ///< the box that the voxels fill, in the file's coordinates
  std::array<double, 3> upper{1, 1, 1};
  /// channels of a voxel are contiguous; of the voxel indices x varies fastest, z slowest
  std::vector<float> values;

  std::size_t voxel(int x, int y, int z) const {
    return ((std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[0]) +
            std::size_t(x)) *
           std::size_t(channels);
  }
};

/// Reads Mitsuba's format .vol: the letters VOL; the version 3 (a byte); then little-endian: the encoding
/// (int32: 1 = float32, 2 = float16, 3 = a byte that represents [0, 1]), the sizes along x, y and z (int32
/// each), the number of channels (int32), the box (six float32: lower corner, upper corner) and the numbers,
/// x fastest, with a voxel's channels contiguous. Throws Error without a location.
VoxelData read_vol(const std::filesystem::path& file);

/// Converts an array of depth x height x width [x channels] numbers. Throws Error without a location.
VoxelData voxels_of_array(const Array& array);

/// Throws Error without a location if a number is not finite.
void check_finite(const VoxelData& data);

/// Reads a grid from the file `filename` or, if a program gives it, from the array `array`. Throws located
/// Errors, also if a number is not finite.
VoxelData read_voxels(const Properties& p, const char* array);
/// Returns the parameter from which `read_voxels` took the grid.
inline const char* voxels_parameter(const Properties& p, const char* array) {
  return p.has(array) ? array : "filename";
}

}  // namespace aureole
