// SPDX-License-Identifier: Apache-2.0
// Mean of a correlated series and its standard error by blocking (Flyvbjerg & Petersen, "Error estimates on
// averages of correlated data", 1989).
#pragma once

#include <cstdint>
#include <vector>

namespace aureole::optics {

struct Estimate {
  double mean = 0, error = 0;  ///< error: one standard deviation of the mean
};

/// Values are added one by one and not kept: level k has the mean and variance of the means of blocks of 2^k
/// values.
class BlockAverage {
public:
  void add(double value);
  /// Adds a series that is independent of this one.
  void merge(const BlockAverage& other);

  std::int64_t count() const { return levels_.empty() ? 0 : levels_[0].blocks; }
  double mean() const { return levels_.empty() ? 0 : levels_[0].mean; }
  /// Standard error of the mean, from the shortest blocks at which it has stopped growing with the length of
  /// the blocks, within its noise; 0 for fewer than two values.
  double error() const;
  Estimate estimate() const { return {mean(), error()}; }
  /// Integrated autocorrelation time in values, 1 where they are independent: n error^2/variance.
  double correlation_time() const;

private:
  struct Level {
    std::int64_t blocks = 0;
    double mean = 0, squares = 0;  // squares of deviations from the mean
    double pending = 0;            // first half of the next level's block
    bool has_pending = false;
    double error() const;
  };
  int plateau() const;
  std::vector<Level> levels_;
};

}  // namespace aureole::optics
