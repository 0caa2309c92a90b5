// SPDX-License-Identifier: Apache-2.0
// Refractive indices of what pigments and fillers are made of, by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/optics/medium/spectral_table.h"

namespace aureole::pigment {

struct GrainIndex {
  std::string name;
  /// n + i k by the wavelength in nm. Crystals that refract doubly have the mean of their ordinary index (twice) and the
  /// extraordinary one, or of all three, since grains lie in all directions. Beyond the range of the source it is that at its ends.
  optics::IndexFunction index;
  double min_nm = 0, max_nm = 0;  ///< of the source; 0 and infinity for a constant
  bool absorbs = false;
  std::string_view source;
};

/// "rutile", "anatase", "zinc oxide", "zinc sulfide", "hematite", "magnetite", "carbon black", "acetylene soot", "calcite", "quartz",
/// "kaolinite", "barite", "gypsum", and names of the trade: "titanium white" (rutile), "zinc white", "iron oxide red", "iron
/// oxide black", "lamp black", "chalk", "china clay", "blanc fixe". Ignores case. Nothing for another name.
std::optional<GrainIndex> find_grain_index(std::string_view name);

/// All names, those of the trade behind the others.
std::vector<std::string> grain_index_names();

}  // namespace aureole::pigment
