// SPDX-License-Identifier: Apache-2.0
// `RadianceVoxels`: density and colour by direction at the voxels of a sparse grid, as files of Plenoxels hold them
// (Fridovich-Keil, Yu and others 2022, "Plenoxels: radiance fields without neural networks").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/core/unfilled.h"
#include "aureole/math/vec.h"

namespace aureole {

struct RadianceVoxels {
  std::array<int, 3> size{1, 1, 1};  ///< voxels along x, y, z
  Vec3 center, radius{1, 1, 1};      ///< the voxels fill the box of center - radius to center + radius
  /// Index of the stored numbers of a voxel, or -1 where density and all coefficients are 0; z is the fastest.
  UnfilledVector<std::int32_t> links;
  UnfilledVector<float> densities;  ///< per length; negative ones count in interpolation, and their sums as 0
  /// Coefficients of real spherical harmonics, (degree + 1)^2 colours per stored voxel in the order of l and then of m.
  /// The colour in the direction in which a camera looks is 1/2 plus their sum, or 0 where that is negative
  /// (spherical_harmonics.h of splats).
  int degree = 0;
  UnfilledVector<float> harmonics;
  bool is_linear = false;          ///< whether the file states that its colours are linear
  std::vector<std::string> notes;  ///< what has no effect or is left out, with counts

  std::size_t stored() const { return densities.size(); }
  std::size_t coefficients() const { return std::size_t((degree + 1) * (degree + 1)); }
  const float* harmonics_of(std::size_t stored) const {
    return harmonics.data() + 3 * coefficients() * stored;
  }
  std::size_t link_index(int x, int y, int z) const {
    return (std::size_t(x) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[2]) + std::size_t(z);
  }
  std::size_t memory_bytes() const;
};

/// Reads an archive of numpy (.npz) with the arrays `links` (nx x ny x nz integers), `density_data` (n x 1), `sh_data`
/// (n x 3 (degree + 1)^2, all coefficients of red first), `radius` and `center` (3 numbers each), as Plenoxels writes it.
/// Or reads a file of OpenVDB or NanoVDB: numbers "density", and vectors "sh_0", "sh_1", ... of coefficients or "color" or "Cd" of
/// linear colours. Throws Error located at the file. Memory is bounded by the size of the file and `require_content`.
RadianceVoxels read_radiance_voxels(const std::filesystem::path& file);

/// Writes such a file with coefficients of float16, as Plenoxels does. Replaces the file as a whole. Throws Error located at
/// the file.
void write_radiance_voxels(const std::filesystem::path& file, const RadianceVoxels& voxels);

/// Whether a file begins as a zip archive and its name ends in ".npz".
bool is_radiance_voxels_file(const std::filesystem::path& file);

}  // namespace aureole
