// SPDX-License-Identifier: Apache-2.0
// Pair correlation and structure factor of points observed through finite windows. Lengths are in any common
// unit.
#pragma once

#include <functional>
#include <vector>

namespace aureole {

/// Points of one field of view.
struct PointField {
  std::vector<double> x, y;
  double area = 0;                                   ///< area of the observation window
  std::function<double(double, double)> covariance;  ///< set covariance of the observation window
  std::vector<int> block;                            ///< block of each point, for the bootstrap
  int blocks = 1;
  std::vector<double> block_area;

  /// Taper on a raster of cells of cell_x x cell_y starting at the origin; 0 outside the window.
  int columns = 0, rows = 0;
  double cell_x = 1, cell_y = 1;
  std::vector<float> taper;
};

/// Counts of pairs by distance in bins of `width`. Each pair is weighted by 1/(covariance of its
/// displacement), the translation correction, and by the field's fraction of the total area. Half of it is
/// counted for the block of either point.
struct PairCounts {
  double width = 0;
  /// Ordered pairs, by [index over all fields' blocks][bin]: estimates of density^2 g(r) 2 pi r width.
  std::vector<std::vector<double>> weighted;
  std::vector<double> count;  ///< number of unordered pairs per bin, over all blocks
};
PairCounts count_pairs(const std::vector<PointField>& fields, double width, int bins);

/// The onset of g(r): position of a step of unknown height, width (errors of centres, spread of sizes; about
/// `expected_width`) and decay, fitted to g(r) with `count` pairs per bin. Its `distance` is twice the
/// correlation radius.
struct Onset {
  double distance = 0, width = 0, contact = 0;
};
Onset fit_onset(const std::vector<double>& distance, const std::vector<double>& pair_correlation,
                const std::vector<double>& count, double guess, double expected_width);

/// Distance of each point to its nearest neighbour.
std::vector<double> nearest_distances(const PointField& field);

/// Computes S(q) = |sum w_i exp(-i q.r_i) - rho W(q)|^2 / sum w_i^2, with the taper w and its transform W, at
/// the vectors q of the window's periods, averaged over rings |q| in [i, i + 1) step. Rings below three of
/// the window's periods are left empty.
struct RingMeans {
  double step = 0;
  /// wave numbers and S with its standard error S/sqrt(independent vectors)
  std::vector<double> q, value, error;
};
RingMeans structure_factor_of(const std::vector<PointField>& fields, double step, int rings);

}  // namespace aureole
