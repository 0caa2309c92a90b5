// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "aureole/core/table_cache.h"

namespace aureole::python {

/// Returns the cache of tables with which scenes are loaded: the one of `aureole.cache.use`, or of the environment; null
/// if there is none.
std::shared_ptr<TableCache> current_tables();

}  // namespace aureole::python
