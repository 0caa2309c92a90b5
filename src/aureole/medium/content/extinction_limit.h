// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "aureole/medium/majorant_grid.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// Throws an error at `parameter`, or at the medium where that is empty, where an extinction [per unit of length] is too large to be
/// computed with: far beyond the limit, products with lengths overflow. NaN is too large.
inline void require_computable_extinction(const Properties& p, std::string_view parameter,
                                          double extinction) {
  constexpr double kLargest = 1e18;
  if (extinction <= kLargest) return;
  const std::string text = fmt::format("the extinction becomes {:.3g}; {:g} per unit of length are possible",
                                       extinction, kLargest);
  throw parameter.empty() ? Error(p.where(), text) : p.error(parameter, text);
}

/// The same where the extinction varies between `factor` times `least` and `factor` times the bounds of the grid. Light is extinct
/// within a few free paths of what there is, but rays step along those of the cell's bound: as many as a cell holds of them in excess.
inline void require_computable_extinction(const Properties& p, std::string_view parameter,
                                          const MajorantGrid& grid, double least, double factor) {
  constexpr double kMostPaths = 1e6;
  const auto& cells = grid.cells();
  const Vec3 cell =
      grid.to_box().inverse().vector({1 / float(cells[0]), 1 / float(cells[1]), 1 / float(cells[2])});
  const double most = double(grid.maximum()) * factor,
               paths = (double(grid.maximum()) - least) * factor * double(length(cell));
  if (!(paths <= kMostPaths))
    throw p.error(
        parameter,
        fmt::format(
            "the extinction varies and goes up to {:.3g} per unit of length, which makes the diagonal "
            "of a cell of its bounds {:.3g} free paths long, and rays step along each; {:g} are possible",
            most, paths, kMostPaths));
}

}  // namespace aureole
