// SPDX-License-Identifier: Apache-2.0
// Upgrades BSDFs that contain other BSDFs.
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Converts `mixturebsdf` to a chain of `blendbsdf`, and a `scale` texture in a `bumpmap` to its parameter;
/// names the texture of a `normalmap`. `bsdf` must already have the current parameter names.
void upgrade_adapter(Node& bsdf, Diagnostics& diagnostics);

}  // namespace aureole
