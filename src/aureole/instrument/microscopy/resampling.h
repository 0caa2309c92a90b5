// SPDX-License-Identifier: Apache-2.0
// Estimates from a set of blocks: all blocks or a resample of the bootstrap. Used by microstructure.cpp only.
#pragma once

#include <iterator>
#include <utility>
#include <vector>

#include "aureole/instrument/microscopy/field_pool.h"
#include "aureole/instrument/microscopy/point_statistics.h"

namespace aureole {

struct SizeMoments {
  double mean = 0, deviation = 0, log_deviation = 0, quantiles[std::size(kQuantiles)] = {};
};
/// Size moments of pairs of radius and weight.
SizeMoments sizes_of(std::vector<std::pair<double, double>> radius_weight);

/// All quantities that the bootstrap repeats.
struct BlockSample {
  double covered, density, onset;
  SizeMoments sizes;
  std::vector<double> g;
};

class BlockEstimator {
public:
  /// `radius_deviation` approximates the error of the distance of two centres at contact.
  BlockEstimator(const Microstructure& m, const std::vector<Block>& blocks,
                 const std::vector<PointField>& points, double radius_deviation);
  bool has_pairs() const { return guess_ > 0; }
  bool fits_onset() const { return fits_; }
  /// Sets up g(r) in `bins` bins of `width`, which all later samples contain.
  void set_pairs(double width, int bins) { pairs_ = count_pairs(points_, width, bins); }
  Onset onset(const std::vector<int>& draw) const;
  BlockSample sample(const std::vector<int>& draw) const;

private:
  double density(const std::vector<int>& draw) const;
  std::vector<double> pair_correlation(const PairCounts& pairs, const std::vector<int>& draw) const;

  const Microstructure& m_;
  const std::vector<Block>& blocks_;
  const std::vector<PointField>& points_;
  double guess_ = 0, smallest_ = 0, expected_width_ = 0;
  bool fits_ = false;
  PairCounts onset_pairs_, pairs_;
  std::vector<double> distance_;
};

/// Standard deviation over resamples, robust against outliers of the fit: half the 16 to 84 % range.
double spread(std::vector<double> v);

}  // namespace aureole
