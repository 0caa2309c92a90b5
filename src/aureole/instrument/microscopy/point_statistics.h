// SPDX-License-Identifier: Apache-2.0
// Pair correlation and structure factor of points that are seen through finite windows. Lengths in one unit
// of the caller's choice.
#pragma once

#include <functional>
#include <vector>

namespace aureole {

/// Points of one field of view.
struct PointField {
  std::vector<double> x, y;
  double area = 0;                                   ///< of the window that the points are from
  std::function<double(double, double)> covariance;  ///< its set covariance
  std::vector<int> block;                            ///< of each point, for the bootstrap
  int blocks = 1;
  std::vector<double> block_area;

  /// Taper on a raster of cells of cell_x x cell_y from the origin, 0 outside of the window.
  int columns = 0, rows = 0;
  double cell_x = 1, cell_y = 1;
  std::vector<float> taper;
};

/// Pairs by distance in bins of `width`, each weighted by 1/(covariance of its displacement), that is the
/// translation correction, and by the field's part of all area; given half to the block of either point.
struct PairCounts {
  double width = 0;
  /// Ordered pairs, by [fields' blocks in sequence][bin]: estimates of density^2 g(r) 2 pi r width.
  std::vector<std::vector<double>> weighted;
  std::vector<double> count;  ///< unordered pairs of each bin, all blocks
};
PairCounts count_pairs(const std::vector<PointField>& fields, double width, int bins);

/// Half the smallest distance of two centres as the onset of g(r): the place of a step of unknown height,
/// width (errors of centres, spread of sizes; about `expected_width`) and decay, fitted to g(r), from `count`
/// pairs in each bin.
struct Onset {
  double distance = 0, width = 0, contact = 0;
};
Onset fit_onset(const std::vector<double>& distance, const std::vector<double>& pair_correlation,
                const std::vector<double>& count, double guess, double expected_width);

/// Distance of each point to its nearest neighbour.
std::vector<double> nearest_distances(const PointField& field);

/// S(q) = |sum w_i exp(-i q.r_i) - rho W(q)|^2 / sum w_i^2, w the taper, W its transform, on the vectors q
/// of the window's own period, averaged over rings |q| in [i, i + 1) step. Rings nearer to 0 than three of
/// the window's periods are left empty.
struct RingMeans {
  double step = 0;
  std::vector<double> q, value, error;  ///< standard error: S/sqrt(independent vectors)
};
RingMeans structure_factor_of(const std::vector<PointField>& fields, double step, int rings);

}  // namespace aureole
