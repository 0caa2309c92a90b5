// SPDX-License-Identifier: Apache-2.0
// The stages of loading one by one, for a scene that stays open (document.h) and for tests.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/loading/parse.h"
#include "aureole/scene/scene_parts.h"

namespace aureole {

class ObjectPool;

/// The objects of a scene file, which are not a scene yet.
struct LoadedParts {
  SceneParts parts;
  ObjectPtr integrator;
  std::uint64_t hash = 0;
  std::vector<std::string> notes;
  std::filesystem::path file;
};

/// The same with the object built for each node.
struct OpenedParts : LoadedParts {
  std::unordered_map<const Node*, ObjectPtr> objects;
};

/// The nodes of a file or of `text`, upgraded, with the changes of `options`, the default objects that the
/// scene does not state, and the notes so far. Throws ErrorList.
std::unique_ptr<ParsedScene> open_scene(const std::filesystem::path& file,
                                        const std::optional<std::string>& text, const LoadOptions& options,
                                        std::vector<std::string>& notes);
/// Builds the objects, with those of `pool` where nothing has changed.
OpenedParts build_opened(ParsedScene& parsed, const LoadOptions& options, ObjectPool& pool);
/// Adds the default integrator where the scene states none.
void complete(ParsedScene& parsed);

/// `load_scene` and `load_scene_from_string` up to the objects.
LoadedParts load_parts(const std::filesystem::path& file, const std::optional<std::string>& text,
                       const LoadOptions& options);
/// The last stage: builds the scene, reusing unchanged acceleration structures of `previous`.
LoadedScene make_scene(LoadedParts parts, const Scene* previous = nullptr);

}  // namespace aureole
