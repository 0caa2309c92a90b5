// SPDX-License-Identifier: Apache-2.0
// Light on layers by other programs: tables that make_stack_references.py writes.
#pragma once

#include <vector>

namespace aureole::optics {

struct DisortReference {
  double cosine, substrate, depth;
  struct Layer {
    double optical_thickness, albedo, share, g1, g2;
  };
  std::vector<Layer> layers;
  /// up at the top; down at the bottom, and unscattered; up, down and unscattered at the depth; up at the bottom
  double fluxes[7];
  double cosines[5];
  /// Radiance of a beam of irradiance 1, by cosine and azimuth: up at the top, down at the bottom, both at the depth.
  double up[15], down[15], up_inside[15], down_inside[15];
};
inline constexpr double kDisortAzimuths[] = {0, 1.0471975511965976, 3.141592653589793};

/// A slab between slides (index 1: none), R and T of a normal beam and of diffuse light.
struct IadReference {
  double albedo, optical_thickness, g, index, slides;
  double reflectance, transmittance, diffuse_reflectance, diffuse_transmittance;
};

#include "optics/stack/references/disort_references.inc"
#include "optics/stack/references/iad_references.inc"

}  // namespace aureole::optics
