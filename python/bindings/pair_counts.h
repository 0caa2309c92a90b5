// SPDX-License-Identifier: Apache-2.0
// Pairs of points by their distance, for g(r) and its error.
#pragma once

#include "vectorised.h"

namespace aureole::python {

/// Memory of `count_pairs` is so many times that of the result.
inline constexpr std::size_t kPairCountBatch = 64;

/// For the points (n, 2) of a box: result[p][b] is the sum over ordered pairs whose first point is in tile p
/// of tiles x tiles and whose distance is between edges b and b + 1, of one over the area in which such a
/// pair can lie: the box where it is `periodic`, else (width - |dx|)(height - |dy|), the translational edge
/// correction (Ohser & Stoyan, "On the second-order and orientation analysis of planar stationary point
/// processes", 1981). The last edge is at most half of the shorter side.
void count_pairs(const Array<const double, 2>& positions, double box_x, double box_y, bool periodic,
                 const Reals& edges, int tiles, const Array<double, 2>& result);

}  // namespace aureole::python
