// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/medium/majorant_grid.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Number of majorant cells along the axes of a grid with `samples` samples along each. A cell is four samples wide, since
/// traversing smaller cells costs more than it saves (docs/performance.md).
std::array<int, 3> majorant_cells(const std::array<int, 3>& samples);

/// Returns upper bounds of a volume that varies in space, in cells of its box. No bound is smaller than
/// `least`.
MajorantGrid majorants_of(const Volume& volume, float least = 0);

}  // namespace aureole
