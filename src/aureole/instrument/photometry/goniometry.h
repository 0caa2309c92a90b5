// SPDX-License-Identifier: Apache-2.0
// The luminaire that a goniophotometer has measured (sensor/goniophotometer.cpp), as files of luminaires have it.
#pragma once

#include <string>

#include "aureole/core/image.h"
#include "aureole/parameter/luminaire/luminaire_file.h"

namespace aureole {

/// How a measurement becomes a file.
struct GoniometryOptions {
  /// The half-planes that are taken for alike and averaged: none; all; C and 360 - C; C and 180 - C; both.
  enum class Symmetry { none, rotational, about_c0, about_c90, quadrants } symmetry = Symmetry::none;
  double flux =
      0;  ///< luminous flux of the luminaire [lm] to which the intensities are scaled; 0: as measured
  double lamp_flux = 0;  ///< luminous flux of its lamps [lm]; 0: absolute photometry
  double watts = 0;      ///< electrical power [W]
  LuminousOpening opening{};
  std::vector<std::pair<std::string, std::string>> keywords{};
};

/// Makes a luminaire of type C from a picture with one intensity [cd] for each C (column) and gamma (row). Throws Error
/// where the picture has no light.
Luminaire measured_luminaire(const Image& picture, const GoniometryOptions& options);

/// Figures of a luminaire for people.
struct LuminaireFigures {
  double flux = 0, downward_flux = 0;  ///< [lm]
  double peak = 0;                     ///< largest intensity [cd]
  double peak_c = 0, peak_gamma = 0;   ///< its direction [degrees]
  /// Full width at half of the intensity at gamma = 0 [degrees], in the planes C 0-180 and C 90-270; 0: it does not fall
  /// to half of it.
  double beam[2] = {};
};
LuminaireFigures luminaire_figures(const Luminaire& luminaire);

}  // namespace aureole
