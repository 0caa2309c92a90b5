// SPDX-License-Identifier: Apache-2.0
// `SplatSettings`: the conventions by which the integrator `splat` makes a picture of splats.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/parameter/splat/splat_cloud.h"
#include "aureole/plugin/registry.h"

namespace aureole {

struct SplatSettings {
  /// How a splat covers the picture: `blended` with opacities in the order of depth, as 3D Gaussian splatting; the others
  /// interpolate the points of the first surface.
  enum class Footprint { blended, point, disc, gaussian, ewa };
  /// Scale of the interpolated colour: `weights` divides the sum by the sum of the footprints; `none` leaves
  /// the sum.
  enum class Normalization { weights, none };
  enum class Compensation { file, on, off };
  /// How a splat meets the picture: projected on it, or by each ray; by itself projected where the sensor is a pinhole.
  enum class Method { automatic, projection, rays };

  Footprint footprint;
  Normalization normalization;
  Method method;
  std::optional<SplatHints::Sorting> sorting;  ///< empty: that of the file
  std::optional<SplatHints::Projection> projection;
  std::optional<SplatHints::Colors> colors;
  Compensation compensation;
  float dilation;  ///< variance that the projection of a splat gains [pixels^2]
  /// Mahalanobis distance at which a footprint ends; 0: that of the file, else 10/3, or 1 for points
  float cutoff;
  float opacity_cap;    ///< largest opacity of a splat at a pixel
  float opacity_limit;  ///< smaller opacities are left out
  float termination;    ///< transmittance below which a ray ends
  float near;           ///< depth before which splats are left out [length]
  /// tangents beyond the picture's border, as its multiple, at which the linearisation is held
  float jacobian_limit;
  float depth_range;  ///< points this far behind the first one belong to its surface, in its radii
  bool at_pixel_center;
  std::optional<Vec3> background;  ///< background, in the colour space of blending

  bool blends() const { return footprint == Footprint::blended; }
  /// A hash of all settings.
  std::uint64_t key() const;

  /// Reads the parameters of the integrator. Throws located Errors.
  static SplatSettings read(const Properties& properties);
  static std::vector<ParameterDoc> rows();
};

}  // namespace aureole
