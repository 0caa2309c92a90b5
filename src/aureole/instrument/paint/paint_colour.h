// SPDX-License-Identifier: Apache-2.0
// Colours of paints under the CIE's lamps, for the 1931 observer, and colours that are asked for.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "aureole/pigment/match.h"

namespace aureole {

/// The CIE 1931 observer under the illuminant of this name. Throws Error, with the nearest name, where there
/// is none, and where the wavelengths do not cover the visible.
pigment::Observation observe(const std::string& illuminant, std::span<const double> nm);

/// "#rrggbb" of tristimulus values relative to a white, which becomes the screen's by von Kries's rule on
/// XYZ.
std::string screen_colour(const pigment::Xyz& xyz, const pigment::Xyz& white);

/// A colour to match, and the palette at the wavelengths at which it is known.
struct ColourTarget {
  pigment::MatchTarget target;
  pigment::Palette palette;
};

/// Reads `text`: "#rrggbb" (sRGB, of D65 only), one of the sixteen colour names of HTML 4, "lab(50, 20, -10)"
/// under this lamp's white, or "FILE#SAMPLE", the mean of the measurements of that name in a file of samples;
/// then the palette is cut to the wavelengths that both have, and interpolated at its own. Throws Error that
/// begins with `option`.
ColourTarget read_colour_target(const std::string& text, const pigment::Palette& palette,
                                const std::string& illuminant, const std::string& option);

}  // namespace aureole
