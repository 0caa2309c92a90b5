// SPDX-License-Identifier: Apache-2.0
// The luminaire that a command is about: an IES or EULUMDAT file, or a scene on a goniophotometer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "aureole/instrument/photometry/goniophotometer_scene.h"
#include "command.h"

namespace aureole {

/// Options that are not given are empty, 0, or -1.
struct LuminaireTarget {
  std::string target, integrator, symmetry, name, maker;
  std::vector<std::string> defines;
  std::int64_t spp = -1, seed = -1, lamp_set = -1;
  int threads = 0;
  double c_step = 0, gamma_step = 0, flux = 0, lamp_flux = 0, watts = 0;
  std::vector<double> down, along, opening;  ///< three numbers each, or empty
  bool quiet = false;

  bool is_file() const;
};

/// Whether the name of a file ends with .ies or .ldt.
bool is_luminaire_file(const std::filesystem::path& file);

/// Adds the target and the options of its measurement to those of a command.
void add_luminaire_target(CommandOptions& options, LuminaireTarget& target);

/// Reads or measures the luminaire, and prints its notes. Throws Error for wrong values before anything is rendered, and for
/// options of a measurement beside a file.
Luminaire luminaire_of(const LuminaireTarget& target);

}  // namespace aureole
