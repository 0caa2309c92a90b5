// SPDX-License-Identifier: Apache-2.0
// Maps of the field around blocks of metal: by a boundary integral equation, by the renderer's model "segments", and the
// difference of both.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "gallery/metal_solver.h"

namespace aureole {

/// Lengths are in wavelengths.
struct FieldScene {
  std::vector<MetalBlock> blocks;
  double degrees;          ///< direction of travel of a plane wave, from the x axis
  double x0, y0, x1, y1;   ///< the rectangle of the map
  double low_db, high_db;  ///< range of the maps
};

/// A map of values in [0, 1], from its upper left corner, row by row.
struct FieldMap {
  int width = 0, height = 0;
  std::vector<double> values;
  std::string caption;
};

/// Returns for soft and for hard waves the power by the solver, that of the renderer, and the magnitude of the
/// difference, in `width` cells to a row, the renderer with so many samples of each; nothing if interrupted. Throws Error if the map has no cell outside the blocks.
std::vector<FieldMap> field_maps(const FieldScene& scene, int width, int samples,
                                 const std::atomic<bool>& stop);

}  // namespace aureole
