// SPDX-License-Identifier: Apache-2.0
// Chromaticities u', v', CIELUV, and the dominant wavelength of a colour.
#pragma once

#include <span>

#include "aureole/pigment/colour_indices.h"

namespace aureole::pigment {

/// u' = 4 X/(X + 15 Y + 3 Z) and v' = 9 Y/(X + 15 Y + 3 Z) of the CIE 1976 diagram; 0 for black.
struct UcsChromaticity {
  double u = 0, v = 0;
};
UcsChromaticity ucs_chromaticity(const Xyz& xyz);

/// CIELUV of tristimulus values relative to a white (CIE 15:2018, 8.2.2).
struct Luv {
  double l = 0, u = 0, v = 0;
};
Luv luv_of_xyz(const Xyz& xyz, const Xyz& white);

/// The wavelength of which white, mixed with it, has the chromaticity of a colour (CIE 15:2018, 9.1). Purples have none: theirs is
/// the complementary wavelength, on the other side of white.
struct DominantWavelength {
  double nm = 0;  ///< 0: the colour is that of the white
  bool is_complementary = false;
  /// Excitation purity: the distance from white over that of the spectrum locus or the purple line.
  double purity = 0;
};
/// `locus` has the chromaticities of monochromatic light of the increasing wavelengths `nm`.
DominantWavelength dominant_wavelength(const Chromaticity& colour, const Chromaticity& white,
                                       std::span<const double> nm, std::span<const Chromaticity> locus);

}  // namespace aureole::pigment
