// SPDX-License-Identifier: Apache-2.0
// The part of upgrading that is about BSDFs that contain others.
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// `mixturebsdf` becomes a chain of `blendbsdf`, a `scale` texture in a `bumpmap` its parameter, and the
/// texture of a `normalmap` gets its name. `bsdf` has today's parameter names already.
void upgrade_adapter(Node& bsdf, Diagnostics& diagnostics);

}  // namespace aureole
