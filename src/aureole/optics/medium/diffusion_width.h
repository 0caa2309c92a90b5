// SPDX-License-Identifier: Apache-2.0
// How wide the light spreads that leaves a half-space where a thin beam has entered it: the width d of a normalised
// diffusion profile (Christensen & Burley 2015), exp(-r/d) + exp(-r/(3 d)) over 8 pi d r, as d = l/s with l the reduced
// mean free path.
#pragma once

#include <vector>

#include "aureole/optics/medium/half_space.h"

namespace aureole::optics {

/// s over the reflectance of the half-space. Fitted to the Monte Carlo transport of isotropic scattering so that the least
/// part of the light leaves at a wrong distance (tests/bssrdf/width_fit_test.cpp makes the numbers): unlike the
/// published formula, which is for equal indices, it follows the index, by which light turns back inside and spreads.
class DiffusionWidth {
public:
  /// `index`: of the half-space over that outside; taken as the nearest in [1, 2]. Throws std::domain_error unless it is
  /// positive.
  DiffusionWidth(double index, Illumination illumination);

  double scale(double reflectance) const;

private:
  std::vector<double> reflectance_, scale_;
};

/// s of Christensen & Burley 2015: for a beam along the normal, and for diffuse light.
double published_diffusion_scale(double reflectance, Illumination illumination);

}  // namespace aureole::optics
