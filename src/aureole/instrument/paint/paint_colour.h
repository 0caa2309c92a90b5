// SPDX-License-Identifier: Apache-2.0
// Colours of paints under CIE illuminants for the 1931 observer, and target colours.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "aureole/pigment/match.h"

namespace aureole {

/// Returns the CIE 1931 observer under the illuminant of this name. Throws Error if there is none, with the
/// nearest name, and if the wavelengths do not cover the visible range.
pigment::Observation observe(const std::string& illuminant, std::span<const double> nm);

/// Returns "#rrggbb" for tristimulus values relative to a white, which is adapted to the screen's white by
/// von Kries's rule on XYZ.
std::string screen_colour(const pigment::Xyz& xyz, const pigment::Xyz& white);

/// A colour to match, and the palette at the wavelengths at which the colour is known.
struct ColourTarget {
  pigment::MatchTarget target;
  pigment::Palette palette;
};

/// Reads `text`: "#rrggbb" (sRGB, D65 only), one of the sixteen colour names of HTML 4, "lab(50, 20, -10)"
/// under this illuminant's white, or "FILE#SAMPLE", the mean of the measurements of that name in a file of
/// samples. For a sample, the palette is cut to the common range of wavelengths and interpolated at the
/// sample's wavelengths. Throws Error that begins with `option`.
ColourTarget read_colour_target(const std::string& text, const pigment::Palette& palette,
                                const std::string& illuminant, const std::string& option);

}  // namespace aureole
