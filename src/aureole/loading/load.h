// SPDX-License-Identifier: Apache-2.0
// Loads a scene file: text -> nodes -> upgraded nodes -> objects -> scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/table_cache.h"
#include "aureole/integrator/integrator.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/table_progress.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// Callback for the names of files that were read. It may throw to cancel the loading.
using FileCheck = std::function<void(const std::vector<std::filesystem::path>& files)>;

/// Changes to a scene that the command line requests.
struct LoadOptions {
  std::vector<std::pair<std::string, std::string>> defines;  ///< definitions -D name=value
  std::string sampler;     ///< plug-in that replaces the sensor's sampler; sample_count and seed are kept
  std::string integrator;  ///< plug-in that replaces the integrator; parameters that it documents are kept
  /// plug-in for a scene that has no integrator; empty: the family's default
  std::string fallback_integrator;
  struct Parameter {
    std::string tag, name, value;
  };
  /// parameters that replace the integrator's parameters of these names
  std::vector<Parameter> integrator_parameters;
  /// Whether BSDFs whose id is that of a building material, such as "mat-itu_concrete", become slabs of it, as in
  /// sionna-rt (loading/radio_materials.h).
  bool radio_materials = false;
  std::optional<std::int64_t> sample_count;
  /// Whether the picture will be denoised: the film gets a box filter, whose pixels have noise of their own, and channels
  /// for albedo and normal of the first surface that is no mirror or glass.
  bool for_denoising = false;
  /// Objects made by the program itself, for elements `<given name="..." key="..."/>`. A key must change with
  /// the object's content, because the scene's hash contains only the key.
  std::map<std::string, ObjectPtr> given;
  /// where tables are kept for the next start of a program; null: nowhere
  std::shared_ptr<TableCache> tables = {};
  TableProgress progress = {};  ///< called during the computation of slow tables; may be null, and may throw
                                ///< to cancel the loading
  /// called with the scene files, included ones too, and all files that they name, before a scene is made; may be null
  FileCheck check_files = {};
};

/// The result of loading a scene file: the scene, its integrator, and its origin.
struct LoadedScene {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Integrator> integrator;
  std::uint64_t hash = 0;  ///< hash of content and referenced files, without sample_count and seed of the
                           ///< sampler
  std::vector<std::string> notes;  ///< notes for the user: first the file's in its order, then the scene's
  std::filesystem::path file;      ///< absolute
  /// Files that the scene names or that its files name, each once: textures, meshes, volumes, spectra; without scene files.
  std::vector<std::filesystem::path> files;
};

/// Loads a scene file. Throws one ErrorList with every problem of the scene, in file order.
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

/// Loads a scene from `text`, read as if it were the content of `pretended_file`.
LoadedScene load_scene_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                   const LoadOptions& options = {});

/// The objects of a scene file, for instruments that measure one of them.
struct LoadedObjects {
  /// Ids, empty where an object has none, and objects in the file's order. An object with an alias is listed
  /// twice.
  std::vector<std::pair<std::string, ObjectPtr>> objects;
  std::shared_ptr<const BuildContext> context;
  std::vector<std::string> notes;
};

/// Builds all objects of a scene file but no scene: the file needs no sensor, and objects that nothing uses are built,
/// too. Spectra are tabulated over the sensor's range, or without a sensor over the visible range. Throws as
/// `load_scene` does.
LoadedObjects load_objects(const std::filesystem::path& file, const LoadOptions& options = {});

/// An object loaded without a scene, such as a BSDF to analyse.
struct LoadedObject {
  ObjectPtr object;
  std::string family;
  std::shared_ptr<const BuildContext> context;
  std::vector<std::string> notes;
};

/// Loads the last object of a scene in `text`; it may refer to objects before it. Spectra are tabulated on
/// `grid`. Throws as `load_scene` does.
LoadedObject load_object_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                     const SpectralGrid& grid, const LoadOptions& options = {});

}  // namespace aureole
