// SPDX-License-Identifier: Apache-2.0
// Plug-ins of Mitsuba 0.6 that are other plug-ins here, with other parameters.
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Converts an object of a scene of version 0.6 whose parameters are in snake case. Each replacement that is
/// not exact is noted.
void upgrade_old_plugin(Node& object, Diagnostics& diagnostics);

}  // namespace aureole
