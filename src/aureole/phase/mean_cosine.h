// SPDX-License-Identifier: Apache-2.0
// Means of a phase function over directions, by quadrature.
#pragma once

#include <array>

#include "aureole/math/vec.h"
#include "aureole/phase/phase.h"

namespace aureole {

/// Returns the mean phase function [1/sr] over azimuths about `about.n`, the direction of propagation, at the
/// scattering angle `angle` (radians) and the point p.
Spectrum mean_over_azimuth(const PhaseFunction& phase, const Frame& about, double angle, const Vec3& p,
                           const Wavelengths& w);

/// Returns the asymmetry parameter g per wavelength: the first moment divided by the integral.
std::array<double, kWavelengths> mean_cosine(const PhaseFunction& phase, const Frame& about, const Vec3& p,
                                             const Wavelengths& w);

}  // namespace aureole
