// SPDX-License-Identifier: Apache-2.0
// CIELAB and the CIEDE2000 colour difference (ISO/CIE 11664-4, 11664-6; G. Sharma, W. Wu, E. N. Dalal, Color
// Res. Appl. 30, 2005).
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

/// CIEDE2000 with k_L = k_C = k_H = 1.
double ciede2000(const Lab& a, const Lab& b);

/// Three components whose squares sum to the square of CIEDE2000, and which are smooth where the colours
/// coincide, as a least-squares fit needs. The rotation term, which couples chroma and hue, is written as a
/// sum of squares.
std::array<double, 3> ciede2000_components(const Lab& a, const Lab& b);

}  // namespace aureole::pigment
