// SPDX-License-Identifier: Apache-2.0
// Mean of a correlated series and its standard error by blocking (Flyvbjerg & Petersen, "Error estimates on
// averages of correlated data", 1989).
#pragma once

#include <cstdint>
#include <vector>

namespace aureole::optics {

struct Estimate {
  double mean = 0, error = 0;  ///< mean, and its error of one standard deviation
};

/// A running average whose values are not stored. Level k keeps the mean and the variance of the means of
/// blocks of 2^k values.
class BlockAverage {
public:
  void add(double value);
  /// Adds a series that is independent of this one.
  void merge(const BlockAverage& other);

  std::int64_t count() const { return levels_.empty() ? 0 : levels_[0].blocks; }
  double mean() const { return levels_.empty() ? 0 : levels_[0].mean; }
  /// Returns the standard error of the mean. It is taken at the shortest block length beyond which the error
  /// no longer grows significantly; 0 for fewer than two values.
  double error() const;
  Estimate estimate() const { return {mean(), error()}; }
  /// Returns the integrated autocorrelation time n error^2/variance, in numbers of values; 1 for independent
  /// values.
  double correlation_time() const;

private:
  struct Level {
    std::int64_t blocks = 0;
    double mean = 0, squares = 0;  // mean, and sum of squared deviations from it
    double pending = 0;            // first half of a block of the next level
    bool has_pending = false;
    double error() const;
  };
  int plateau() const;
  std::vector<Level> levels_;
};

}  // namespace aureole::optics
