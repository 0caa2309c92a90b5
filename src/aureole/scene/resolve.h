// SPDX-License-Identifier: Apache-2.0
// Fourth stage of loading: ids, references and file names.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "aureole/scene/parse.h"

namespace aureole {

/// What the references of a scene point to. Holds pointers into the node tree, which must not change any
/// more.
struct References {
  std::map<std::string, const Node*> ids;                ///< aliases included
  std::unordered_map<const Node*, const Node*> targets;  ///< of each good <ref>
  std::unordered_set<const Node*> nested;                ///< objects that a <ref> inside another object uses
  std::vector<std::filesystem::path> files;              ///< referenced by parameters, in order
};

/// Makes file names absolute and finds the target of every reference. Reports duplicate ids, unknown ids,
/// circular references and files that do not exist.
References resolve(ParsedScene& scene, Diagnostics& diagnostics);

/// A number that changes with the content of the scene and of the referenced files, but not with comments,
/// white space, places, or the sampler's sample_count and seed.
std::uint64_t content_hash(const Node& root, const References& references);

}  // namespace aureole
