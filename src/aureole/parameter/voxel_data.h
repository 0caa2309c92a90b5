// SPDX-License-Identifier: Apache-2.0
// `VoxelData`: the numbers of a dense grid as a file or a program gives them.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "aureole/plugin/array.h"
#include "aureole/plugin/properties.h"

namespace aureole {

struct VoxelData {
  std::array<int, 3> size{};             ///< voxels along x, y, z
  int channels = 1;                      ///< numbers of a voxel
  std::array<double, 3> lower{0, 0, 0};  ///< the box that the voxels fill, in the coordinates of the file
  std::array<double, 3> upper{1, 1, 1};
  std::vector<float> values;  ///< channels of a voxel together, then x, then y, then z

  std::size_t voxel(int x, int y, int z) const {
    return ((std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[0]) +
            std::size_t(x)) *
           std::size_t(channels);
  }
};

/// Mitsuba's format .vol: the letters VOL; the version 3 (a byte); then little-endian: the encoding (int32: 1 =
/// float32, 2 = float16, 3 = a byte that stands for [0, 1]), the sizes along x, y and z (int32 each), the number
/// of channels (int32), the box (six float32: its lower corner, its upper one) and the numbers, x fastest, of a
/// voxel all channels together. Throws Error without a location.
VoxelData read_vol(const std::filesystem::path& file);

/// An array of depth x height x width [x channels] numbers. Throws Error without a location.
VoxelData voxels_of_array(const Array& array);

/// Throws Error without a location where a number is not finite.
void check_finite(const VoxelData& data);

/// The grid that the file `filename` or, from a program, the array named `array` holds. All its numbers are
/// finite; what is wrong is a located error.
VoxelData read_voxels(const Properties& p, const char* array);
/// The parameter that `read_voxels` took it from.
inline const char* voxels_parameter(const Properties& p, const char* array) {
  return p.has(array) ? array : "filename";
}

}  // namespace aureole
