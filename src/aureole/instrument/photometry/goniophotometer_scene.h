// SPDX-License-Identifier: Apache-2.0
// The scene of a goniophotometer: a luminaire's scene with that sensor in the place of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/instrument/photometry/goniometry.h"
#include "aureole/loading/load.h"

namespace aureole {

struct GoniophotometerSettings {
  std::string scene;  ///< file
  std::vector<std::pair<std::string, std::string>> defines;
  std::string integrator;              ///< empty: ptracer
  std::int64_t spp = 256;              ///< samples per direction
  double c_step = 15, gamma_step = 5;  ///< steps of the angles [degrees]
  std::vector<double> down{0, 0, -1};  ///< direction gamma = 0 in the scene, three numbers
  std::vector<double> along;  ///< direction along the luminaire; empty: x, or y where x is along `down`
  std::shared_ptr<TableCache> tables = {};  ///< cache of the scene's tables; null: none
  FileCheck check_files = {};  ///< called with the files that the scene is read from; may be null
};

/// Where the scene comes from: a file or a text that is read as the content of a file, in which a sensor may then be replaced.
struct GoniophotometerSource {
  std::optional<std::string> text;
  std::filesystem::path file;
  LoadOptions load;
  std::string sensor;  ///< XML element that replaces the scene's sensor; empty: `text` has it
};

/// Throws Error that names the option for wrong values, and the errors of the scene.
GoniophotometerSource goniophotometer_source(const GoniophotometerSettings& settings,
                                             const TableProgress& progress = {});
/// Loads the scene of the settings.
LoadedScene load_goniophotometer(const GoniophotometerSettings& settings);
/// Throws Error located at an emitter that does not belong to a luminaire.
void require_luminaire(const Scene& scene);

/// The symmetry of that name: none, rotational, c0, c90 or quadrants. Throws Error for another one.
GoniometryOptions::Symmetry symmetry_of(const std::string& name);
/// The keywords of a file for the measurement with these settings; empty names stand for those of the scene's file, and for
/// an unknown maker.
std::vector<std::pair<std::string, std::string>> measurement_keywords(const GoniophotometerSettings& settings,
                                                                      const std::string& name,
                                                                      const std::string& maker);

}  // namespace aureole
