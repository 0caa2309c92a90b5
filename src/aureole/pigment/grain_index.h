// SPDX-License-Identifier: Apache-2.0
// Indices of refraction of pigments and fillers, by material name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/optics/medium/spectral_table.h"

namespace aureole::pigment {

struct GrainIndex {
  std::string name;
  /// n + i k by the wavelength in nm. Birefringent crystals have the mean of the ordinary index (weight 2)
  /// and the extraordinary one, or of all three, because grains are randomly oriented. Outside the source's
  /// range, the value at its limit is used.
  optics::IndexFunction index;
  double min_nm = 0, max_nm = 0;  ///< range of the source; 0 and infinity for a constant
  bool absorbs = false;
  std::string_view source;
};

/// Returns the index of a material, or nothing for an unknown name; case is ignored. Materials: "rutile",
/// "anatase", "zinc oxide", "zinc sulfide", "hematite", "magnetite", "carbon black", "acetylene soot",
/// "calcite", "quartz", "kaolinite", "barite", "gypsum". Trade names: "titanium white" (rutile), "zinc
/// white", "iron oxide red", "iron oxide black", "lamp black", "chalk", "china clay", "blanc fixe".
std::optional<GrainIndex> find_grain_index(std::string_view name);

/// All names: materials first, then trade names.
std::vector<std::string> grain_index_names();

}  // namespace aureole::pigment
