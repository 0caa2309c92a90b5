// SPDX-License-Identifier: Apache-2.0
// CIELAB and colour differences: CIE 1976, CMC(l:c), CIE94, CIEDE2000 and DIN99o.
#pragma once

#include <array>

namespace aureole::pigment {

using Xyz = std::array<double, 3>;

/// CIELAB coordinates L*, a*, b*.
struct Lab {
  double l = 0, a = 0, b = 0;
};

/// CIELAB of tristimulus values relative to a white; all values are positive.
Lab lab_of_xyz(const Xyz& xyz, const Xyz& white);
Xyz xyz_of_lab(const Lab& lab, const Xyz& white);

/// Chroma C*ab, and hue angle h_ab in degrees, in [0, 360) and 0 for a grey.
double chroma(const Lab& lab);
double hue_degrees(const Lab& lab);

/// Differences of a sample from a standard in lightness, chroma and hue, sample minus standard. Their squares sum to
/// the square of Delta E*ab; Delta H* is positive if the sample's hue angle is larger (counterclockwise).
struct LchDifference {
  double l = 0, c = 0, h = 0;
};
LchDifference lch_difference(const Lab& standard, const Lab& sample);

/// Delta E*ab, the distance in CIELAB (ISO/CIE 11664-4).
double cie1976(const Lab& a, const Lab& b);

/// CMC(l:c) of a sample from a standard (F. J. J. Clarke, R. McDonald, B. Rigg, J. Soc. Dyers Colour. 100, 1984;
/// ISO 105-J03). It is not symmetric. 2:1 is usual for acceptability, 1:1 for perceptibility.
double cmc(const Lab& standard, const Lab& sample, double l = 2, double c = 1);

/// The parametric factors of CIE94.
enum class Cie94 {
  graphic_arts,  ///< k_L = 1, K_1 = 0.045, K_2 = 0.015: paints and prints
  textiles       ///< k_L = 2, K_1 = 0.048, K_2 = 0.014
};
/// CIE94 of a sample from a standard, with the standard's chroma in the weights (CIE 116-1995). It is not symmetric.
double cie94(const Lab& standard, const Lab& sample, Cie94 application = Cie94::graphic_arts);

/// Coordinates L99o, a99o, b99o of DIN 6176:2018, in which the Euclidean distance is the colour difference. Constants
/// k_E = k_CH = 1.
Lab din99o_of_lab(const Lab& lab);
double din99o(const Lab& a, const Lab& b);

/// CIEDE2000 with k_L = k_C = k_H = 1 (ISO/CIE 11664-6; G. Sharma, W. Wu, E. N. Dalal, Color Res. Appl. 30, 2005).
double ciede2000(const Lab& a, const Lab& b);

/// Three components whose squares sum to the square of CIEDE2000, and which are smooth where the colours
/// coincide, as a least-squares fit needs. The rotation term, which couples chroma and hue, is written as a
/// sum of squares.
std::array<double, 3> ciede2000_components(const Lab& a, const Lab& b);

}  // namespace aureole::pigment
