// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/medium/majorant_grid.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Returns upper bounds of a volume that varies in space, in cells of its box. No bound is smaller than
/// `least`.
MajorantGrid majorants_of(const Volume& volume, float least = 0);

}  // namespace aureole
