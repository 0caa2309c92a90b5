// SPDX-License-Identifier: Apache-2.0
// Palettes of paint (pigment/paints.h) by file, and recipes by the names of their paints, with located errors.
#pragma once

#include <string>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/spectrum/spectrum.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The name of the measured paints that come with the program, in the place of a file.
inline constexpr const char* kMeasuredPaints = "kimera";

/// Reads a palette as `pigment::palette_text` writes it. `kimera` is the palette of the library.
pigment::Palette read_palette_file(const std::string& file);

/// Fractions of a recipe ("red: 1 + white: 3"), one for each pigment. By volume, densities are needed. Throws
/// Error that begins with `option` and names the nearest paint where one is unknown.
std::vector<double> recipe_fractions(const pigment::Palette& palette, const std::string& recipe,
                                     bool by_volume, const std::string& option);

/// K and S on a scene's grid.
struct SampledPaint {
  SampledSpectrum k, s;
};
/// Those of a mixture, times a factor: linear between the palette's wavelengths, and beyond them as at its ends.
SampledPaint sampled_paint(const SpectralGrid& grid, const pigment::Palette& palette,
                           const std::vector<double>& fractions, double factor);

}  // namespace aureole
