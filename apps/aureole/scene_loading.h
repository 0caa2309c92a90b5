// SPDX-License-Identifier: Apache-2.0
// Options that all commands which load a scene have in common.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "aureole/core/table_cache.h"
#include "aureole/loading/load.h"
#include "command.h"

namespace aureole {

/// Adds the option --cache.
void add_cache_option(CommandOptions& options);

/// Returns the cache of --cache or else of the environment; null if there is none.
std::shared_ptr<TableCache> table_cache();

/// Returns the options for a scene with the values of its $names, written NAME=VALUE, with the cache of the command, and with
/// `keep_files_of_scene`. Throws Error.
LoadOptions load_options(const std::vector<std::string>& defines);

/// Adds the files of a scene to the command's inputs. Throws Error where an output would replace one, such as the .png beside an
/// .exr a texture.
void keep_files_of_scene(const std::vector<std::filesystem::path>& files);

}  // namespace aureole
