// SPDX-License-Identifier: Apache-2.0
// Measures the light budget of any BSDF: direct and diffuse transmission, reflection, and haze (ASTM D1003:
// the fraction of transmitted light deviating more than 2.5 degrees from the regular direction).
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// Fractions of the light arriving at one wavelength.
struct LightBudget {
  double nm = 0;
  /// fractions transmitted in the regular direction, within the angle around it, and beyond the angle
  double direct_transmission = 0, near_transmission = 0, far_transmission = 0;
  double direct_reflection = 0, diffuse_reflection = 0;
  double transmission() const { return direct_transmission + near_transmission + far_transmission; }
  double reflection() const { return direct_reflection + diffuse_reflection; }
  double lost() const { return 1 - transmission() - reflection(); }
};

struct LightBudgetSettings {
  double haze_angle_degrees = 2.5;
  int samples = 1 << 16;
  Vec2 uv{0.5f, 0.5f};  ///< texture coordinates of the point on the surface
};

/// Measures light arriving from `wi` (outward, local frame) with samples of the BSDF at Sobol points. The
/// error is a few 1e-4 for BSDFs with good importance sampling.
LightBudget measure_light_budget(const Bsdf& bsdf, const Vec3& wi, double nm, const SpectralGrid& grid,
                                 const LightBudgetSettings& settings);

}  // namespace aureole
