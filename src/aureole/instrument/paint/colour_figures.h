// SPDX-License-Identifier: Apache-2.0
// The figures by which the paint industry judges the colour of a measured reflectance, alone and against a
// standard.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/pigment/colour_strength.h"

namespace aureole {

/// The colour of one reflectance.
struct ColourFigures {
  pigment::Xyz xyz{};  ///< tristimulus values, with Y = 100 for a perfect diffuser
  pigment::Chromaticity chromaticity;
  pigment::Lab lab;
  std::optional<pigment::Whiteness> whiteness;  ///< CIE whiteness; only under D65, for which it is defined
  std::optional<double> yellowness;             ///< yellowness by ASTM E313; only under C and D65
};

/// A sample against a standard, all differences sample minus standard.
struct ColourComparison {
  pigment::Lab lab;            ///< differences in L*, a*, b*
  pigment::LchDifference lch;  ///< differences in lightness, chroma and hue
  double cie1976 = 0, cmc = 0, cie94 = 0, ciede2000 = 0, din99o = 0;
  /// strength of the colorant; nothing if K/S cannot be determined
  std::optional<pigment::ColourStrength> strength;
  std::string no_strength;      ///< reason why there is no strength
  pigment::LchDifference tone;  ///< tint tone: colour difference at equal strength at the absorption maximum
  double tone_ciede2000 = 0;
  std::vector<double> metamerism;  ///< special indices (Delta E*ab), one for each of the other viewings
};

struct ColourSettings {
  std::string viewing = "D65";           ///< illuminant and observer, as for `observe`
  std::vector<std::string> others = {};  ///< other illuminants and observers, for metamerism
  double cmc_l = 2, cmc_c = 1;           ///< l and c of CMC(l:c)
  pigment::Cie94 cie94 = pigment::Cie94::graphic_arts;
  pigment::StrengthSettings strength = {};
  /// The standard as the samples' instrument would measure it, for strength and tint tone; empty: as it is given.
  std::vector<double> standard_for_strength = {};
};

/// Reflectances have one value for each wavelength. Errors are those of `observe`.
ColourFigures colour_figures(const std::vector<double>& nm, const std::vector<double>& reflectance,
                             const std::string& viewing);
ColourComparison compare_colours(const std::vector<double>& nm, const std::vector<double>& standard,
                                 const std::vector<double>& sample, const ColourSettings& settings);

}  // namespace aureole
