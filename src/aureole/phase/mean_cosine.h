// SPDX-License-Identifier: Apache-2.0
// Means of a phase function over directions, by quadrature.
#pragma once

#include <array>

#include "aureole/math/vec.h"
#include "aureole/phase/phase.h"

namespace aureole {

/// The mean [1/sr], over azimuths about `about.n`, of the light that is scattered by `angle` (radians) from that
/// direction of travel, at the point p.
Spectrum mean_over_azimuth(const PhaseFunction& phase, const Frame& about, double angle, const Vec3& p,
                           const Wavelengths& w);

/// The asymmetry g per wavelength: the first moment over the integral.
std::array<double, kWavelengths> mean_cosine(const PhaseFunction& phase, const Frame& about, const Vec3& p,
                                             const Wavelengths& w);

}  // namespace aureole
