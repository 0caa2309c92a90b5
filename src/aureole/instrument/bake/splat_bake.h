// SPDX-License-Identifier: Apache-2.0
// Baking: the light that leaves a scene's surfaces, followed by its integrator, as Gaussian splats or points.
#pragma once

#include <string>
#include <vector>

#include "aureole/instrument/bake/surface_light.h"
#include "aureole/loading/load.h"
#include "aureole/parameter/splat/splat_cloud.h"

namespace aureole {

struct SplatBakeOptions {
  bool as_points = false;     ///< points with normals, radii and colours, else Gaussian splats
  std::size_t count = 20000;  ///< points of the surfaces
  SurfaceLight::Density density = SurfaceLight::Density::area;
  int degree = 0;         ///< of the harmonics; points have 0
  int paths = 64;         ///< paths of each point, in directions of the hemisphere on the side of its normal
  float exposure = 1;     ///< factor of the light before it is encoded as sRGB
  float coverage = 0.6f;  ///< standard deviation of a splat, in mean distances of points
  float opacity = 0.99f;  ///< of a splat; the cap of published viewers
  std::uint64_t seed = 0;
};

struct SplatBake {
  SplatCloud cloud;
  std::vector<std::string> notes;
  double area = 0;  ///< total area of the surfaces [length^2]
};

/// Distributes points over the scene's surfaces and estimates the radiance that leaves each of them, in linear
/// sRGB in units of D65. A colour is the mean over the hemisphere or, with harmonics, their least-squares fit, encoded as
/// sRGB. The result does not depend on the number of threads. Throws Error if there is no surface to bake.
SplatBake bake_splats(const LoadedScene& loaded, const SplatBakeOptions& options);

}  // namespace aureole
