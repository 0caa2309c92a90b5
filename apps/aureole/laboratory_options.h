// SPDX-License-Identifier: Apache-2.0
// Options of the instruments that measure a material of a scene: lengths and wavelengths.
#pragma once

#include <string>
#include <vector>

#include "aureole/instrument/laboratory/bench.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Reads an option's length with a unit into metres; an empty text leaves the value. Throws Error with the option's name.
void set_length(const char* option, const std::string& text, double& metres);

/// Throws Error unless `range` holds two increasing or equal wavelengths in nm.
void check_range(const std::vector<double>& range);

/// Returns the bands of an instrument over `range` [nm], at most `step` apart; `usual_step` counts where `step` is not positive.
/// The bands are `bandwidth` wide, or as wide as they are apart where that is 0 (10 nm for one band).
Bands bands_over(const std::vector<double>& range, const SpectralGrid& grid, double step, double usual_step,
                 double bandwidth);

}  // namespace aureole
