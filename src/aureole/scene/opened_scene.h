// SPDX-License-Identifier: Apache-2.0
// The stages of loading for a scene that stays open (document.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "aureole/scene/adoption.h"
#include "aureole/scene/build.h"
#include "aureole/scene/parse.h"

namespace aureole {

/// What the nodes became. The shapes of `adoptions` are in the scene already, but have the children of the
/// build before.
struct OpenedScene {
  LoadedScene scene;
  std::unordered_map<const Node*, ObjectPtr> objects;
  std::vector<Adoption> adoptions;
};

/// The nodes of a file or of `text`, and the notes so far.
std::unique_ptr<ParsedScene> open_scene(const std::filesystem::path& file,
                                        const std::optional<std::string>& text, const LoadOptions& options,
                                        std::vector<std::string>& notes);
/// Builds the objects, with those of `pool` where nothing has changed. Where it throws, the objects of the
/// pool are as they were.
OpenedScene build_opened(ParsedScene& parsed, const LoadOptions& options, ObjectPool& pool);
/// Adds what a scene needs and does not state: an integrator.
void complete(ParsedScene& parsed);

}  // namespace aureole
