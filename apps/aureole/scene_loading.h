// SPDX-License-Identifier: Apache-2.0
// Options that all commands which load a scene have in common.
#pragma once

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

/// Returns the options for a scene with the values of its $names, written NAME=VALUE, and with the cache of the command.
/// Throws Error.
LoadOptions load_options(const std::vector<std::string>& defines);

}  // namespace aureole
