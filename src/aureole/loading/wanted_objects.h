// SPDX-License-Identifier: Apache-2.0
// Objects of a scene file for a program that measures one of them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "aureole/loading/load.h"

namespace aureole {

/// Whether an object is wanted, by its id, which is empty where it has none.
using IsWanted = std::function<bool(const std::string& id, const ObjectPtr& object)>;

/// As `load_objects`, but with those notes alone that are about wanted objects, about elements within them or objects that they
/// refer to, and about what belongs to no object of the file.
LoadedObjects load_wanted_objects(const std::filesystem::path& file, const LoadOptions& options,
                                  const IsWanted& is_wanted);

}  // namespace aureole
