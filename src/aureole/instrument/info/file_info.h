// SPDX-License-Identifier: Apache-2.0
// Descriptions of scenes, pictures, volumes, splats, radiance grids and state files, as `aureole info` prints them.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/table_cache.h"
#include "aureole/math/vec.h"

namespace aureole {

/// A description in lines. Each begins with a label of at most 12 letters, filled up to 13 columns, or with blanks where it
/// goes on with the line above.
struct FileInfo {
  std::string kind;                ///< "scene", "picture", "volume", "splats", "radiance grid" or "state"
  std::string text;                ///< whole lines
  std::vector<std::string> notes;  ///< how the file was understood where that is not obvious
};

/// Describes a file by its content. `defines` are the values of a scene's $names. Throws Error for a file that cannot be
/// read or is none of these, and for defines of any other file than a scene. `tables`: the cache of a scene's tables.
FileInfo file_info(const std::filesystem::path& file,
                   const std::vector<std::pair<std::string, std::string>>& defines = {},
                   const std::shared_ptr<TableCache>& tables = {});

/// Describes the content of a scene: film, wavelengths, sensor, integrator, shapes, tables, emitters. Implemented in
/// scene_info.cpp.
FileInfo scene_info(const std::filesystem::path& file,
                    const std::vector<std::pair<std::string, std::string>>& defines,
                    const std::shared_ptr<TableCache>& tables);
/// Describes size, format, origin, noise, colours and channels of a picture. Implemented in picture_info.cpp.
FileInfo picture_info(const std::filesystem::path& file);
/// Describes the picture that a state file belongs to, and how much of it is done. Implemented in picture_info.cpp.
FileInfo state_info(const std::filesystem::path& file);
/// Describes size, type, spacing, position in space and range of values of a volume. Implemented in volume_info.cpp.
FileInfo volume_info(const std::filesystem::path& file);
/// Whether a file holds splats or points, by its first bytes or its extension.
bool is_splats(const std::filesystem::path& file);
/// Describes what a file of splats holds and by which conventions. Implemented in splat_info.cpp.
FileInfo splat_info(const std::filesystem::path& file);
/// Describes size, stored voxels and range of densities of a radiance grid. Implemented in splat_info.cpp.
FileInfo radiance_grid_info(const std::filesystem::path& file);

/// The voxels in the middle of a grid along one of its axes: a picture whose axes are the other two, in their order.
struct GridSlice {
  int width = 0, height = 0;
  std::vector<float>
      values;  ///< of the first channel; rows of `width`, the second axis increases with the row
  std::array<double, 2> spacing{1, 1};  ///< of voxels along both axes of the picture
  int index = 0, count = 0;             ///< of the slice, and number of slices
};
/// Returns the middle slice across `axis` of a grid of that size, without spacing and values; sets the axes along its rows and columns.
inline GridSlice middle_slice(const std::array<int, 3>& size, int axis, std::size_t& u, std::size_t& v) {
  u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  GridSlice slice;
  slice.width = size[u], slice.height = size[v];
  slice.count = size[std::size_t(axis)], slice.index = slice.count / 2;
  return slice;
}
/// Reads the slice across the axis 0, 1 or 2 of a volume. Implemented in volume_info.cpp.
GridSlice volume_slice(const std::filesystem::path& file, int axis);
/// Reads the densities in the slice across the axis 0, 1 or 2 of a radiance grid. Implemented in splat_info.cpp.
GridSlice radiance_grid_slice(const std::filesystem::path& file, int axis);

/// Centres of splats or points.
struct SplatPoints {
  std::vector<Vec3> positions;
  std::vector<Vec3> colors;  ///< as a display shows them (sRGB), the mean over all directions, in [0, 1]
  std::vector<float> opacities;
  std::size_t count = 0;  ///< of the file
};
/// Reads at most `most` splats of a file, at equal steps of their order. Implemented in splat_info.cpp.
SplatPoints splat_points(const std::filesystem::path& file, std::size_t most);

}  // namespace aureole
