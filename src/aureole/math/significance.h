// SPDX-License-Identifier: Apache-2.0
// Statistical significance tests of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "aureole/math/vec.h"

namespace aureole {

/// The significance level of each of `tests` tests for a family-wise error rate of `family` (Sidak 1967).
double sidak_level(double family, std::size_t tests);

/// Returns P(X >= statistic) for a chi-square distribution.
double chi_square_p_value(double statistic, std::size_t degrees_of_freedom);

/// Exact two-sided p-value of `count` successes in `trials` at `probability`.
double binomial_p_value(std::size_t count, std::size_t trials, double probability);

/// Two-sided p-value of a standard normal variable.
double normal_p_value(double z);

/// Independent uniform numbers in [0, 1), determined by the seed.
class SeededRandom {
public:
  explicit SeededRandom(std::uint64_t seed) : seed_(seed) {}
  float next();
  Vec2 next2() {
    const float x = next();
    return {x, next()};
  }

private:
  std::uint64_t seed_, counter_ = 0;
};

struct ChiSquareResult {
  double p_value = 1, statistic = 0;
  std::size_t bins = 0;
};

/// Tests the `counts` of `trials` samples against the bins' masses. The mass missing to 1 is outside the
/// bins. Consecutive bins are pooled until at least `least_expected` samples are expected in each pool.
ChiSquareResult chi_square_test(std::span<const double> masses, std::span<const std::size_t> counts,
                                std::size_t trials, double least_expected = 5);

/// Like `chi_square_test`, for masses known only to a relative standard error. Bins with fewer than
/// `least_expected` samples are pooled, wherever they are. Their pool is tested if more than `least_rest`
/// samples are expected in it.
struct CoarseChiSquareResult : ChiSquareResult {
  double rest_expected = 0, rest_found = 0;  ///< expected and found samples in the pool of small bins
  bool tests_rest = false;
};
CoarseChiSquareResult coarse_chi_square_test(std::span<const double> masses,
                                             std::span<const std::size_t> counts, std::size_t trials,
                                             double relative_error, double least_expected = 10,
                                             double least_rest = 5);

}  // namespace aureole
