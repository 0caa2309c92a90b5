// SPDX-License-Identifier: Apache-2.0
// Loading a scene file: text -> nodes -> upgraded nodes -> objects.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class Shape;
class Emitter;

/// What the command line changes in a scene.
struct LoadOptions {
  std::vector<std::pair<std::string, std::string>> defines;  ///< -D name=value
  std::string sampler;     ///< plug-in that replaces the sensor's sampler, which keeps sample_count and seed
  std::string integrator;  ///< plug-in that replaces the integrator, which keeps the parameters it documents
  std::optional<std::int64_t> sample_count;
};

struct LoadedScene {
  std::vector<std::shared_ptr<Shape>> shapes;
  std::vector<std::shared_ptr<Emitter>> emitters;  ///< top-level ones; those of shapes stay with their shapes
  ObjectPtr sensor, integrator;
  std::shared_ptr<const BuildContext> context;
  std::uint64_t hash = 0;  ///< of content and referenced files, without sample_count and seed of the sampler
  std::vector<std::string> notes;  ///< for the user, in file order
  std::filesystem::path file;      ///< absolute
};

/// Throws one ErrorList with every problem of the scene, in file order.
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

/// The same for `text`, which is read as if it were the content of `pretended_file`.
LoadedScene load_scene_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                   const LoadOptions& options = {});

}  // namespace aureole
