// SPDX-License-Identifier: Apache-2.0
// `ScalarGrid`: the numbers of a regular grid as a file stores them, with the position of the grid in space. Files
// that are not compressed are mapped, so that a grid larger than the memory can be opened.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "aureole/core/mapped_file.h"
#include "aureole/math/transform.h"

namespace aureole {

struct VoxelData;

/// The type of a stored number.
enum class ScalarType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float16,
  float32,
  float64
};
std::size_t bytes_of(ScalarType type);
/// Returns the numpy name of a type, such as "uint16".
const char* name_of(ScalarType type);

struct ScalarGrid {
  std::array<int, 3> size{1, 1, 1};  ///< number of voxels along the three axes
  int channels = 1;                  ///< numbers per voxel
  int frames = 1;  ///< number of grids in the file, such as time steps; one of them was chosen

  ScalarType type = ScalarType::float32;
  SharedBytes numbers;      ///< stored numbers of the chosen frame; need not be aligned
  bool is_swapped = false;  ///< whether numbers are stored with the most significant byte first
  /// Distance between successive numbers along x, y, z and between successive channels, counted in numbers.
  std::array<std::int64_t, 4> strides{1, 1, 1, 1};
  double slope = 1, intercept = 0;  ///< value = slope * stored number + intercept

  /// Transform from the index of a voxel to RAS coordinates (x to the patient's right, y to the front, z up) in the
  /// unit `unit_m`. The centre of voxel (i, j, k) is at the index (i, j, k). Files that state no anatomical
  /// directions have their own coordinates here. Never singular.
  Transform index_to_ras;
  double unit_m = 1e-3;            ///< metres per unit of length of `index_to_ras`
  bool unit_is_stated = false;     ///< whether the file states the unit; else it is a millimetre
  bool spacing_is_stated = false;  ///< whether the file states the distance between voxels; else it is 1
  bool has_transform = false;      ///< whether the format can state a position in space
  /// name of the format, such as "NRRD"; and letters of the directions, such as "LPS", or empty for a space
  /// without anatomical directions
  std::string format, space;
  std::vector<std::string> notes;                    ///< parts of the file that have no effect
  std::vector<std::filesystem::path> further_files;  ///< files with numbers, besides the one that was named

  /// Returns the value at a voxel inside the grid.
  float value(int x, int y, int z, int channel = 0) const;
  /// Sets out[i] to the value at voxel (x + i, y, z).
  void read_row(int x, int y, int z, int channel, std::span<float> out) const;
  /// Returns the smallest and largest value of all channels; NaN is skipped. Reads all numbers.
  std::array<float, 2> range() const;
  /// Returns the distance of neighbouring centres along the three axes, in units of `unit_m`.
  std::array<double, 3> spacing() const;
  /// Returns the transform from the index of a voxel to RAS coordinates in units of `length_unit_m` metres.
  Transform index_to_world(double length_unit_m) const;
  /// Throws Error without a location if a number is not finite. Reads all numbers of floating point.
  void check_finite() const;
};

/// Choices among the contents of a file, and properties that it does not state.
struct ScalarGridOptions {
  std::string array;  ///< name of an array of a .vti file; empty: its active scalars, else its first array
  int frame = 0;      ///< index of the frame in a file with several, from 0
  bool is_series = false;        ///< whether the file is a slice, one of a numbered series in its folder
  std::optional<double> unit_m;  ///< unit of length that replaces the one in the file [m]
  std::string space;  ///< directions of increasing coordinates that replace the file's: "RAS", "LPS", ...
  /// Distances between voxels for files that state none; an error for files that state them.
  std::optional<std::array<double, 3>> spacing;
  /// centre of the first voxel, for files that state no distances
  std::optional<std::array<double, 3>> origin;
};

/// Reads a grid from a file of the formats NRRD, MetaImage, NIfTI, .vti, .npy, TIFF and .vol, recognised by its
/// first bytes. Throws Error located at the file, with the line for headers of text. Memory is bounded by the
/// size of the file and `require_content`.
ScalarGrid read_scalar_grid(const std::filesystem::path& file, const ScalarGridOptions& options = {});

/// Returns the numbers of a grid in memory, without a copy.
ScalarGrid grid_of_voxels(const std::shared_ptr<const VoxelData>& data);

/// Whether a file begins like one of these formats; TIFF is excluded, since it may be a picture. Throws Error
/// if the file cannot be read.
bool is_scalar_grid_file(const std::filesystem::path& file);

}  // namespace aureole
