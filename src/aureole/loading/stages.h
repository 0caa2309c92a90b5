// SPDX-License-Identifier: Apache-2.0
// The single stages of loading, for scenes that stay open (document.h) and for tests.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/loading/parse.h"
#include "aureole/scene/scene_parts.h"

namespace aureole {

class ObjectPool;

/// The objects of a scene file, before a scene is made from them.
struct LoadedParts {
  SceneParts parts;
  ObjectPtr integrator;
  std::uint64_t hash = 0;
  std::vector<std::string> notes;
  std::filesystem::path file;
  std::vector<std::filesystem::path> files;  ///< that the scene and its files name, each once
};

/// LoadedParts, together with the object built for each node.
struct OpenedParts : LoadedParts {
  NodeTable<ObjectPtr> objects;
};

/// Parses and upgrades the nodes of a file or of `text`, applies the changes of `options` and adds the
/// default objects that the scene does not state. Adds to `notes`. Throws ErrorList.
std::unique_ptr<ParsedScene> open_scene(const std::filesystem::path& file,
                                        const std::optional<std::string>& text, const LoadOptions& options,
                                        std::vector<std::string>& notes);
/// Builds the objects, reusing objects of `pool` whose elements have not changed.
OpenedParts build_opened(ParsedScene& parsed, const LoadOptions& options, ObjectPool& pool);
/// Adds the default integrator if the scene has none.
void complete(ParsedScene& parsed);

/// Loads as `load_scene` and `load_scene_from_string` do, but stops before a scene is made from the objects.
LoadedParts load_parts(const std::filesystem::path& file, const std::optional<std::string>& text,
                       const LoadOptions& options);
/// The last stage: builds the scene, reusing unchanged acceleration structures of `previous`.
LoadedScene make_scene(LoadedParts parts, const Scene* previous = nullptr);

}  // namespace aureole
