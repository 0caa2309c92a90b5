// SPDX-License-Identifier: Apache-2.0
// Spectra of measured colours: a linear map from linear sRGB (under D65) to reflectances, for tables of colours
// without an upper bound, such as BRDFs.
#pragma once

#include <array>

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns the spectra of the red, the green and the blue primary, tabulated on the grid. They lie in [0, 1]
/// and sum to one; outside of 380 to 780 nm they keep the value at the end. The spectrum r R + g G + b B has
/// the colour (r, g, b), is linear in it, and is flat for greys (I. Mallett and C. Yuksel, "Spectral primary
/// decomposition for rendering with sRGB reflectance", EGSR 2019; recomputed by tools/make_rgb_primaries.py).
std::array<SampledSpectrum, 3> rgb_primaries(const SpectralGrid& grid);

/// Returns the spectrum of a colour in linear sRGB, by the primaries of `rgb_primaries`.
inline Spectrum rgb_spectrum(const std::array<SampledSpectrum, 3>& primaries, const std::array<float, 3>& rgb,
                             const Wavelengths& w) {
  return primaries[0].eval(w) * rgb[0] + primaries[1].eval(w) * rgb[1] + primaries[2].eval(w) * rgb[2];
}

}  // namespace aureole
