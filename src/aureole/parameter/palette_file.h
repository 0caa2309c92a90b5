// SPDX-License-Identifier: Apache-2.0
// Reads palettes of paints (pigment/paints.h) from files, and recipes by paint names, with located errors.
#pragma once

#include <string>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/spectrum.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The name of the built-in palette of measured paints, used in place of a file name.
inline constexpr const char* kMeasuredPaints = "kimera";

/// Reads a palette in the format of `pigment::palette_text`. `kimera` is the built-in palette.
pigment::Palette read_palette_file(const std::string& file);

/// Returns the fractions of a recipe ("red: 1 + white: 3"), one for each pigment. Proportions by volume need
/// densities. Throws an Error that begins with `option` and suggests the nearest name for an unknown paint.
std::vector<double> recipe_fractions(const pigment::Palette& palette, const std::string& recipe,
                                     bool by_volume, const std::string& option);

/// Notes, at the parameter that named the palette, where the film's range exceeds its wavelengths.
void note_palette_range(const Properties& properties, std::string_view name, const pigment::Palette& palette);

/// Values at increasing wavelengths on a scene's grid: linear between the wavelengths, constant beyond them.
SampledSpectrum sampled_values(const SpectralGrid& grid, const std::vector<double>& nm,
                               const std::function<double(std::size_t)>& value);

/// K and S on a scene's grid.
struct SampledPaint {
  SampledSpectrum k, s;
};
/// Returns K and S of a mixture times a factor (`sampled_values`).
SampledPaint sampled_paint(const SpectralGrid& grid, const pigment::Palette& palette,
                           const std::vector<double>& fractions, double factor);

}  // namespace aureole
