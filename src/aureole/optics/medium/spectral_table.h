// SPDX-License-Identifier: Apache-2.0
// Measured spectra as functions of the wavelength.
#pragma once

#include <span>

#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

struct SpectralPoint {
  double lambda_nm, value;
};

/// Linear between points, constant beyond them. Throws std::domain_error where there is no point, wavelengths
/// do not increase, or a value is negative or not finite.
SpectralFunction spectral_table(std::span<const SpectralPoint> points);

/// A function that is constant over wavelength.
SpectralFunction spectral_constant(double value);

}  // namespace aureole::optics
