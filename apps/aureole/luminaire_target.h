// SPDX-License-Identifier: Apache-2.0
// The luminaire that a command is about: an IES or EULUMDAT file, or a scene on a goniophotometer.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/photometry/goniophotometer_scene.h"
#include "command.h"

namespace aureole {

/// Options that are not given are empty, and `threads` is 0.
struct LuminaireTarget {
  std::string target, integrator, symmetry, name, maker;
  std::vector<std::string> defines, outputs;
  std::optional<std::int64_t> spp, seed, lamp_set;
  int threads = 0;
  std::optional<double> c_step, gamma_step, flux, lamp_flux, watts;
  std::vector<double> down, along, opening;  ///< three numbers each, or empty
  bool quiet = false;

  bool is_file() const;
};

/// Whether the name of a file ends with .ies or .ldt.
bool is_luminaire_file(const std::filesystem::path& file);

/// Adds the target and the options of its measurement to those of a command.
void add_luminaire_target(CommandOptions& options, LuminaireTarget& target);

/// Reads or measures the luminaire, prints its notes, and writes it to the files of -o. Throws Error for wrong values before
/// anything is rendered, for options of a measurement beside a file, and for options of a written file where none is written.
Luminaire luminaire_of(const LuminaireTarget& target);

/// Writes a luminaire to an .ies or .ldt file.
void write_luminaire(const std::filesystem::path& file, const Luminaire& luminaire);

}  // namespace aureole
