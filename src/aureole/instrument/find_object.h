// SPDX-License-Identifier: Apache-2.0
// Finds an object of a scene file by its id, for instruments that measure one.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"
#include "aureole/loading/wanted_objects.h"
#include "aureole/medium/medium.h"

namespace aureole {

/// Returns the BSDF with that id, or the BSDF of the shape with that id.
inline std::shared_ptr<const Bsdf> find_bsdf(const LoadedObjects& loaded, const std::string& file,
                                             const std::string& id) {
  std::vector<std::string> known;
  for (const auto& [its_id, object] : loaded.objects) {
    const auto asset = std::dynamic_pointer_cast<const Asset>(object);
    const bool has_parts = asset && !asset->primitives().empty();
    const auto bsdf = has_parts ? asset->primitives()[0].bsdf : std::dynamic_pointer_cast<const Bsdf>(object);
    if (!bsdf || its_id.empty()) continue;
    if (its_id == id) return bsdf;
    known.push_back(its_id);
  }
  throw Error({file, 0, 0},
              (id.empty() ? "name a BSDF or a shape after \"#\""
                          : "no BSDF or shape has the id \"" + id + "\"" + did_you_mean(id, known)) +
                  (known.empty() ? "; none of this scene has an id"
                                 : fmt::format("; there are {}", fmt::join(known, ", "))));
}

/// Returns the medium with that id; without an id, the only medium of the scene.
inline std::shared_ptr<const Medium> find_medium(const LoadedObjects& loaded, const std::string& file,
                                                 const std::string& id) {
  std::vector<std::shared_ptr<const Medium>> all;
  std::vector<std::string> known;
  for (const auto& [its_id, object] : loaded.objects) {
    const auto medium = std::dynamic_pointer_cast<const Medium>(object);
    if (!medium) continue;
    if (!id.empty() && its_id == id) return medium;
    if (!its_id.empty()) known.push_back(its_id);
    if (std::find(all.begin(), all.end(), medium) == all.end()) all.push_back(medium);
  }
  if (id.empty() && all.size() == 1) return all[0];
  std::string message = !id.empty()   ? "no medium has the id \"" + id + "\"" + did_you_mean(id, known)
                        : all.empty() ? "the scene has no medium"
                                      : fmt::format("name one of the {} media after \"#\"", all.size());
  if (all.empty() && !id.empty()) message += "; the scene has no medium";
  if (!known.empty()) message += fmt::format("; there are {}", fmt::join(known, ", "));
  throw Error({file, 0, 0}, message);
}

/// Objects of that id are wanted.
inline IsWanted has_id(const std::string& id) {
  return [id](const std::string& its_id, const ObjectPtr&) { return its_id == id; };
}

/// The medium that `find_medium` returns is wanted.
inline IsWanted is_medium_called(const std::string& id) {
  if (!id.empty()) return has_id(id);
  return [](const std::string&, const ObjectPtr& object) {
    return std::dynamic_pointer_cast<const Medium>(object) != nullptr;
  };
}

/// Divides "scene.xml#id" at its last "#" into the file and the id, which may be empty.
inline std::pair<std::string, std::string> file_and_id(const std::string& target) {
  const std::size_t mark = target.rfind('#');
  return {target.substr(0, mark), mark == std::string::npos ? "" : target.substr(mark + 1)};
}

}  // namespace aureole
