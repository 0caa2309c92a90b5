// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "aureole/medium/majorant_grid.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// Throws an error where an extinction [1/length] exceeds the limit beyond which its products with lengths
/// may overflow, or is NaN. The error is located at `parameter`, or at the medium if `parameter` is empty.
inline void require_computable_extinction(const Properties& p, std::string_view parameter,
                                          double extinction) {
  constexpr double kLargest = 1e18;
  if (extinction <= kLargest) return;
  const std::string text = fmt::format("the extinction becomes {:.3g}; {:g} per unit of length are possible",
                                       extinction, kLargest);
  throw parameter.empty() ? Error(p.where(), text) : p.error(parameter, text);
}

/// Throws an error at `parameter` where a varying extinction would make rays take too many steps. The
/// extinction lies between `factor * least` and `factor` times the bounds of `grid`. Rays step by free paths
/// of each cell's bound, so a cell of diagonal L holds up to (bound - least) * factor * L null collisions.
inline void require_computable_extinction(const Properties& p, std::string_view parameter,
                                          const MajorantGrid& grid, double least, double factor) {
  constexpr double kMaxPaths = 1e6;
  const auto& cells = grid.cells();
  const Vec3 cell =
      grid.to_box().inverse().vector({1 / float(cells[0]), 1 / float(cells[1]), 1 / float(cells[2])});
  const double most = double(grid.maximum()) * factor,
               paths = (double(grid.maximum()) - least) * factor * double(length(cell));
  if (!(paths <= kMaxPaths))
    throw p.error(
        parameter,
        fmt::format(
            "the extinction varies and goes up to {:.3g} per unit of length, which makes the diagonal "
            "of a cell of its bounds {:.3g} free paths long, and rays step along each; {:g} are possible",
            most, paths, kMaxPaths));
}

}  // namespace aureole
