// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/content/volume_majorants.h"

#include <algorithm>

namespace aureole {

std::array<int, 3> majorant_cells(const std::array<int, 3>& samples) {
  constexpr int kSamplesPerCell = 4, kMaxCells = 256;
  std::array<int, 3> cells;
  for (std::size_t i = 0; i < 3; ++i)
    cells[i] = std::clamp((samples[i] + kSamplesPerCell - 1) / kSamplesPerCell, 1, kMaxCells);
  return cells;
}

MajorantGrid majorants_of(const Volume& volume, float least) {
  const std::array<int, 3> cells = majorant_cells(volume.resolution());
  std::vector<float> bounds(std::size_t(cells[0]) * std::size_t(cells[1]) * std::size_t(cells[2]));
  volume.bound(cells, bounds);
  for (float& b : bounds) b = std::max(b, least);
  return MajorantGrid(volume.to_box().value_or(Transform()), cells, std::move(bounds));
}

}  // namespace aureole
