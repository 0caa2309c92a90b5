// SPDX-License-Identifier: Apache-2.0
// The scene of a power map: that of the user, or any scene to which a map on a plane and transmitters are added.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/radio/power_map.h"
#include "aureole/loading/load.h"

namespace aureole {

/// The options of `aureole powermap` that change the scene. Vectors have the numbers that are said, or none.
struct PowerMapSettings {
  std::string scene;       ///< file
  std::string integrator;  ///< replaces the scene's; empty: the scene's, or ptracer on a plane
  std::vector<std::pair<std::string, std::string>> defines;
  std::optional<int> max_depth;
  bool diffraction = false;
  std::string diffraction_model;
  std::string polarisation;           ///< `diffraction_polarisation` of the integrator; empty: the scene's
  std::vector<double> plane, normal;  ///< centre and normal (default: z) of a map on a plane; three numbers
  std::vector<double> size;           ///< width and height of the plane, in the scene's units
  std::vector<double> transmitters;   ///< isotropic transmitters of 1 W, three numbers each
  std::string frequency;              ///< such as "3.5GHz"
  double cell = 0;                    ///< side of a cell of the plane; 0: 200 cells along the longer side
  std::shared_ptr<TableCache> tables = {};  ///< cache of the scene's tables; null: none
  FileCheck check_files = {};  ///< called with the files that the scene is read from; may be null
};

/// Where a scene comes from: a file, or a text that is read as the content of a file.
struct PowerMapSource {
  std::optional<std::string> text;
  std::filesystem::path file;
  LoadOptions load;
};

/// Throws Error that names the option for contradictions and wrong values.
PowerMapSource power_map_source(const PowerMapSettings& settings);

/// Loads the scene of the settings. Throws Error as `power_map_source` and `load_scene` do.
LoadedScene load_power_map(const PowerMapSettings& settings);

/// Notes on light that a map on a plane misses, and on cells that differ from the ones asked for.
std::vector<std::string> power_map_notes(const PowerMapSettings& settings, const LoadedScene& loaded);

/// Text such as "28 GHz" for wavelengths above 0.1 mm, else in nanometres.
std::string band_text(const PowerMap& map);

/// The maps as one picture: density, free_space, relative_dB, received_dBm and, with variances, error_dB of each.
Image power_map_image(const std::vector<PowerMap>& maps);
/// The quantity of each channel of `power_map_image`, with its unit, for the header of the picture.
std::vector<std::string> power_map_meanings(const std::vector<std::string>& channels);

}  // namespace aureole
