// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/content/volume_majorants.h"

#include <algorithm>

namespace aureole {

namespace {

/// Number of majorant cells along an axis with `samples` samples. A cell is four samples wide, since
/// traversing smaller cells costs more than it saves (docs/performance.md).
int cells_for(int samples) {
  constexpr int kSamplesPerCell = 4, kMaxCells = 256;
  return std::clamp((samples + kSamplesPerCell - 1) / kSamplesPerCell, 1, kMaxCells);
}

}  // namespace

MajorantGrid majorants_of(const Volume& volume, float least) {
  std::array<int, 3> cells;
  for (std::size_t i = 0; i < 3; ++i) cells[i] = cells_for(volume.resolution()[i]);
  std::vector<float> bounds(std::size_t(cells[0]) * std::size_t(cells[1]) * std::size_t(cells[2]));
  volume.bound(cells, bounds);
  for (float& b : bounds) b = std::max(b, least);
  return MajorantGrid(volume.to_box().value_or(Transform()), cells, std::move(bounds));
}

}  // namespace aureole
