// SPDX-License-Identifier: Apache-2.0
#include "laboratory_options.h"

#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/instrument/wavelength_steps.h"

namespace aureole {

void set_length(const char* option, const std::string& text, double& metres) {
  if (text.empty()) return;
  try {
    metres = parse_length_m(text);
  } catch (const Error& e) {
    throw Error(fmt::format("{} {}: {}", option, text, e.message()));
  }
}

void check_range(const std::vector<double>& range) {
  if (!(range[0] > 0 && range[1] >= range[0]))
    throw Error("--range: two wavelengths in nm are expected, as in 400,700");
}

Bands bands_over(const std::vector<double>& range, const SpectralGrid& grid, double step, double usual_step,
                 double bandwidth) {
  Bands bands;
  if (range[1] > range[0]) {
    SpectralGrid measured = grid;
    measured.min_nm = range[0], measured.max_nm = range[1];
    bands.nm = wavelength_steps(measured, step, usual_step);
  } else {
    bands.nm = {range[0]};
  }
  bands.width_nm = bandwidth > 0 ? bandwidth : bands.nm.size() > 1 ? bands.nm[1] - bands.nm[0] : 10;
  return bands;
}

}  // namespace aureole
