// SPDX-License-Identifier: Apache-2.0
// Converts the measurement of a goniophotometer (sensor/goniophotometer.cpp) to a luminaire, as luminaire
// files describe it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "aureole/core/image.h"
#include "aureole/parameter/luminaire/luminaire_file.h"

namespace aureole {

/// Settings by which a measurement becomes a luminaire file.
struct GoniometryOptions {
  /// The half-planes that are assumed equal and averaged: none; all; C and 360 - C; C and 180 - C; both.
  enum class Symmetry { none, rotational, about_c0, about_c90, quadrants } symmetry = Symmetry::none;
  /// luminous flux of the luminaire [lm] to which the intensities are scaled; 0: as measured
  double flux = 0;
  double lamp_flux = 0;                      ///< luminous flux of its lamps [lm]; 0: absolute photometry
  double watts = 0;                          ///< electrical power [W]
  std::optional<LuminousOpening> opening{};  ///< nothing: that of the file; a measurement has a point
  std::vector<std::pair<std::string, std::string>> keywords{};
};

/// Makes a luminaire of type C from a picture with one intensity [cd] for each C (column) and gamma (row). Throws Error
/// where the picture has no light.
Luminaire measured_luminaire(const Image& picture, const GoniometryOptions& options);

/// Reads a luminaire file, for which `options` state other fluxes, power, luminous opening or keywords.
/// Throws Error.
Luminaire read_changed_luminaire(const std::filesystem::path& file, std::size_t lamp_set,
                                 const GoniometryOptions& options);

/// Figures of a luminaire for a report.
struct LuminaireFigures {
  double flux = 0, downward_flux = 0;  ///< luminous flux, all and below the horizontal [lm]
  double peak = 0;                     ///< largest intensity [cd]
  double peak_c = 0, peak_gamma = 0;   ///< direction of the peak [degrees]
  /// Full width at half of the intensity at gamma = 0 [degrees], in the planes C 0-180 and C 90-270; 0: the
  /// intensity does not fall to half.
  double beam[2] = {};
};
LuminaireFigures luminaire_figures(const Luminaire& luminaire);

}  // namespace aureole
