// SPDX-License-Identifier: Apache-2.0
// Baking: the light that leaves a scene's surfaces, as density and colour by direction in a sparse grid.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/parameter/radiance/radiance_voxels.h"

namespace aureole {

struct RadianceBakeOptions {
  int resolution = 128;  ///< voxels along the longest side of the box of the surfaces
  int degree = 0;        ///< of the harmonics
  int paths = 64;        ///< of each voxel with a surface
  float exposure = 1;    ///< factor of the light before it is encoded as sRGB
  /// Optical thickness of a wall along its normal.
  float thickness = 5;
  std::uint64_t seed = 0;
};

struct RadianceBake {
  RadianceVoxels voxels;
  std::vector<std::string> notes;
  double area = 0;  ///< of the surfaces [length^2]
  std::size_t occupied =
      0;  ///< voxels with a surface; the others that are stored surround them, without density
};

/// The density at a voxel is in proportion to the area of the surfaces around it, weighted as trilinear interpolation weights it;
/// the colour of voxels with a surface is the light that leaves the surfaces in them, in linear sRGB in units of D65, encoded as
/// sRGB. Their neighbours get mean colours, so that the colours of interpolated positions are those of a surface. The result
/// does not depend on the number of threads. Throws Error if there is no surface to bake.
RadianceBake bake_radiance_grid(const LoadedScene& loaded, const RadianceBakeOptions& options);

}  // namespace aureole
