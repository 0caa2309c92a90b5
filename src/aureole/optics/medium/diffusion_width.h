// SPDX-License-Identifier: Apache-2.0
// Spread of the light that leaves a half-space after a thin beam has entered it. It is the width d = l/s of a
// normalised diffusion profile (Christensen & Burley 2015), exp(-r/d) + exp(-r/(3 d)) over 8 pi d r, with l
// the reduced mean free path.
#pragma once

#include <vector>

#include "aureole/optics/medium/half_space.h"

namespace aureole::optics {

/// The scale s as a function of the half-space's reflectance. It is fitted to Monte Carlo transport with
/// isotropic scattering such that the least fraction of the light leaves at a wrong distance
/// (tests/bssrdf/width_fit_test.cpp prints the numbers). The published formula is for equal indices. The fit
/// depends on the index, since internal reflection increases the spread.
class DiffusionWidth {
public:
  /// `index` is the index of refraction of the half-space over the index outside, clamped to [1, 2]. Throws
  /// std::domain_error unless it is positive.
  DiffusionWidth(double index, Illumination illumination);

  double scale(double reflectance) const;

private:
  std::vector<double> reflectance_, scale_;
};

/// Returns the scale s of Christensen & Burley 2015, for a beam along the normal or for diffuse light.
double published_diffusion_scale(double reflectance, Illumination illumination);

}  // namespace aureole::optics
