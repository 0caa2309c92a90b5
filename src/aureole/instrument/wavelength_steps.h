// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns wavelengths in nm from one end of a grid to the other, both included, at most `step` nm apart. Without a step
/// (0) they are `usual_step` nm apart, or a hundredth of the range where that is more, as for radio. Throws Error for
/// more than 10000 of them.
inline std::vector<double> wavelength_steps(const SpectralGrid& grid, double step, double usual_step) {
  const double range = grid.max_nm - grid.min_nm;
  if (!(step > 0)) step = std::max(usual_step, range / 100);
  const double steps = std::ceil(range / step - 1e-9);
  if (steps > 10000) throw Error("--step: more than 10000 wavelengths");
  const int count = std::max(1, int(steps));
  std::vector<double> nm;
  for (int i = 0; i <= count; ++i) nm.push_back(grid.min_nm + range * i / count);
  return nm;
}

}  // namespace aureole
