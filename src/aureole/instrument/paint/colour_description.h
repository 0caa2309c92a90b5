// SPDX-License-Identifier: Apache-2.0
// The colour of spectra and of stated colours in the coordinates of the CIE, and differences of two colours.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/pigment/colour_difference.h"
#include "aureole/pigment/colour_indices.h"
#include "aureole/pigment/colour_spaces.h"

namespace aureole {

/// A colour, and its spectrum if it has one.
struct NamedColour {
  std::string name;
  std::vector<double> nm, values;  ///< wavelengths [nm] and reflectances; empty for a stated colour
  pigment::Xyz xyz{}, white{};     ///< a perfect diffuser has Y = 1
};

/// Colours that a text names: the samples of a file (.csv, .cxf, .cgats), one of them as FILE#SAMPLE, or a stated colour
/// (#rrggbb, a name of HTML, lab(L, a, b)). `viewing` is an illuminant and an observer as for `observe`. Notes are appended.
/// Throws Error that begins with `option` or the file.
std::vector<NamedColour> colours_called(const std::string& text, const std::string& viewing,
                                        const std::string& option, std::vector<std::string>& notes);
/// The single colour of a text. Throws Error where a file has several samples.
NamedColour colour_called(const std::string& text, const std::string& viewing, const std::string& option,
                          std::vector<std::string>& notes);

/// Coordinates of a colour (CIE 15:2018).
struct ColourDescription {
  pigment::Xyz xyz{};  ///< Y = 100 for a perfect diffuser
  pigment::Chromaticity xy;
  pigment::UcsChromaticity uv;
  pigment::Lab lab;
  pigment::Luv luv;
  std::string screen;                                   ///< "#rrggbb", adapted to the screen's white
  std::optional<pigment::DominantWavelength> dominant;  ///< nothing for colours of the white's chromaticity
  std::optional<pigment::Whiteness> whiteness;          ///< under D65
  std::optional<double> yellowness;                     ///< ASTM E313; under C and D65
};
ColourDescription describe_colour(const NamedColour& colour, const std::string& viewing);

/// A colour minus a standard.
struct ColourDifference {
  pigment::Lab lab;
  pigment::LchDifference lch;
  double cie1976 = 0, ciede2000 = 0, cmc = 0, cie94 = 0, din99o = 0;
  /// Special indices of metamerism (Delta E*ab) by illuminant; empty unless both colours have spectra of equal wavelengths.
  std::vector<std::pair<std::string, double>> metamerism;
};
/// `cmc` has l and c, `others` illuminants and observers of metamerism as for `observe`.
ColourDifference colour_difference(const NamedColour& standard, const NamedColour& colour,
                                   const std::string& viewing, const std::vector<double>& cmc,
                                   const std::vector<std::string>& others, std::vector<std::string>& notes);

}  // namespace aureole
