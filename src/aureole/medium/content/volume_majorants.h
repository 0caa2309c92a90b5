// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/medium/majorant_grid.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Bounds of a volume that varies in space, in cells of its box: `least` where they are smaller.
MajorantGrid majorants_of(const Volume& volume, float least = 0);

}  // namespace aureole
