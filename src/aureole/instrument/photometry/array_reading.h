// SPDX-License-Identifier: Apache-2.0
// A lamp, or pixels of a spectral picture, as an array spectroradiometer reads them and as its user corrects the readings.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "aureole/optics/photometry/spectroradiometer.h"
#include "aureole/pigment/colour_indices.h"

namespace aureole {

struct ArrayReadingSettings {
  std::string target;  ///< an illuminant, a lamp's file, or a spectral picture (.exr)
  std::vector<double> pixel,
      region;                 ///< x, y, or x, y, width, height of a part of the picture; empty: all of it
  std::vector<double> lines;  ///< of the calibration lamp [nm]; empty: mercury and argon
  optics::ArraySpectrograph array;
  int deconvolution = 0;  ///< iterations of Richardson and Lucy against the slit function
  std::uint64_t seed = 0;
  bool keep_stray = false;  ///< stray light is not corrected
};

struct ArrayReading {
  std::vector<double> nm, values;  ///< by the calibrated scale; in the unit of the lamp or the picture
  std::vector<double> truth;       ///< the spectrum itself at these wavelengths
  pigment::Chromaticity xy, true_xy;
  double scale_residual_nm = 0;  ///< root of the mean square of the lines' deviations
  double mean_deviation = 0;     ///< mean of |value - truth| over the mean of truth
  std::size_t lines = 0;
  std::vector<std::string> notes;
};
/// Calibrates the array by lamp lines and a lamp of even power, and reads the target. Throws Error for numbers that describe no
/// spectrograph, for pictures without spectra, parts outside of them, too few lines, and where there is no light.
ArrayReading read_by_array(const ArrayReadingSettings& settings);

}  // namespace aureole
