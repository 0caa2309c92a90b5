// SPDX-License-Identifier: Apache-2.0
// Measured spectra as functions of the wavelength.
#pragma once

#include <limits>
#include <span>

#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

struct SpectralPoint {
  double lambda_nm, value;
};

/// The wavelengths over which a material was measured; its functions are constant beyond them.
struct DataRange {
  double min_nm = 0, max_nm = std::numeric_limits<double>::infinity();
};

/// Returns a function that is linear between the points and constant beyond them. Throws std::domain_error if
/// there is no point, if wavelengths do not increase, or if a value is negative or not finite.
SpectralFunction spectral_table(std::span<const SpectralPoint> points);

/// Returns a function that is constant over wavelengths.
SpectralFunction spectral_constant(double value);

}  // namespace aureole::optics
