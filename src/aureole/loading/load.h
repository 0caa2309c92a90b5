// SPDX-License-Identifier: Apache-2.0
// Loading a scene file: text -> nodes -> upgraded nodes -> objects -> scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/table_progress.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// Changes that the command line makes to a scene.
struct LoadOptions {
  std::vector<std::pair<std::string, std::string>> defines;  ///< -D name=value
  std::string sampler;     ///< plug-in that replaces the sensor's sampler, which keeps sample_count and seed
  std::string integrator;  ///< plug-in that replaces the integrator, which keeps the parameters it documents
  std::optional<std::int64_t> sample_count;
  /// Objects that the program made itself: `<given name="..." key="..."/>` stands for one of them. A key must
  /// change with the object's content: the scene's hash contains only the key.
  std::map<std::string, ObjectPtr> given;
  TableProgress progress = {};  ///< told of tables that take long; may be null, and may throw to give up
};

/// The content of a scene file: the scene, its integrator, and its origin.
struct LoadedScene {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Integrator> integrator;
  std::uint64_t hash = 0;  ///< of content and referenced files, without sample_count and seed of the sampler
  std::vector<std::string> notes;  ///< for the user: those of the file in its order, then the scene's
  std::filesystem::path file;      ///< absolute
};

/// Throws one ErrorList with every problem of the scene, in file order.
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

/// The same for `text`, which is read as if it were the content of `pretended_file`.
LoadedScene load_scene_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                   const LoadOptions& options = {});

/// An object that stands alone, such as a BSDF to look at.
struct LoadedObject {
  ObjectPtr object;
  std::string family;
  std::shared_ptr<const BuildContext> context;
  std::vector<std::string> notes;
};

/// The last object of a scene in `text`; those before it are what it refers to. Spectra are tabulated on
/// `grid`. Throws as `load_scene` does.
LoadedObject load_object_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                     const SpectralGrid& grid, const LoadOptions& options = {});

}  // namespace aureole
