// SPDX-License-Identifier: Apache-2.0
// The CIE 1931 observer and illuminant D65 on a scene's spectral grid, and the matrix from XYZ to linear
// sRGB.
#pragma once

#include <array>

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns x-bar, y-bar and z-bar of the CIE 1931 2-degree observer on `grid`, divided by the integral of
/// y-bar [1/nm], so that a flat spectrum of radiance 1 has Y = 1.
std::array<SampledSpectrum, 3> observer_xyz(const SpectralGrid& grid);

/// Returns illuminant D65 scaled to a luminance `scale` times that of a flat spectrum of value 1.
SampledSpectrum d65_spectrum(const SpectralGrid& grid, double scale);

/// Converts XYZ to linear sRGB (IEC 61966-2-1, D65 white).
void xyz_to_srgb(const double* xyz, float rgb[3]);

}  // namespace aureole
