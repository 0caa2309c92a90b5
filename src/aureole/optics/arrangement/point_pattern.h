// SPDX-License-Identifier: Apache-2.0
// Structure factor and pair correlation of points in rectangular, non-periodic windows, such as the positions
// of droplets in micrographs.
#pragma once

#include <vector>

#include "aureole/optics/arrangement/block_average.h"

namespace aureole::optics {

struct PointPattern {
  double width = 0, height = 0;
  std::vector<double> x, y;  ///< coordinates of the points in [0, width] x [0, height]
};

/// Returns the smallest |q| at which S(q) can be estimated in a window. Below it the transform of the mean
/// density dominates.
double smallest_wave(const PointPattern& window);

/// Estimates S at each of `q`, averaged over directions and fields. Points are weighted by a Hann taper
/// (sin^2 along both sides) against the window's side lobes, and the transform of the mean density is
/// subtracted. The resolution in q is about 12/side.
/// The power at one wave vector has a standard deviation equal to its mean, so the error follows from the
/// number of independent wave vectors. Throws std::domain_error for fields without points or with points
/// outside, and for q below `smallest_wave` of any field.
std::vector<Estimate> window_structure_factor(const std::vector<PointPattern>& fields,
                                              const std::vector<double>& q, int directions = 48);

/// Estimates g(r) between successive `edges` (r >= 0, increasing, up to half of the shorter side), with
/// translational edge correction (Ohser & Stoyan, "On the second-order and orientation analysis of planar
/// stationary point processes", 1981). Standard errors are by jackknife: each of tiles x tiles parts of each
/// field is left out once, as the first points of pairs (after Loh, "A valid and fast spatial bootstrap for
/// correlation functions", 2008).
std::vector<Estimate> window_pair_correlation(const std::vector<PointPattern>& fields,
                                              const std::vector<double>& edges, int tiles = 3);

}  // namespace aureole::optics
