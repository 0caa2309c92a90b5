// SPDX-License-Identifier: Apache-2.0
// Significance tests of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "aureole/math/vec.h"

namespace aureole {

/// The level of each of `tests` tests that together are wrong with probability `family` (Sidak 1967).
double sidak_level(double family, std::size_t tests);

/// P(X >= statistic) for a chi-square distribution.
double chi_square_p_value(double statistic, std::size_t degrees_of_freedom);

/// Two-sided, exact: how unusual are `count` successes of `trials` at `probability`.
double binomial_p_value(std::size_t count, std::size_t trials, double probability);

/// Two-sided, of a standard normal.
double normal_p_value(double z);

/// Independent uniform numbers in [0, 1), all a function of the seed.
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

/// Tests `counts[bin]` of `trials` samples against the bins' masses; the mass that is missing to 1 lies
/// elsewhere. Bins that follow one another are pooled until at least `least_expected` samples are expected in
/// each.
ChiSquareResult chi_square_test(std::span<const double> masses, std::span<const std::size_t> counts,
                                std::size_t trials, double least_expected = 5);

/// The same for masses that are known only to a relative standard error. Bins with fewer than
/// `least_expected` samples are pooled, wherever they lie; their pool is tested where more than
/// `least_rest` samples are expected in it.
struct CoarseChiSquareResult : ChiSquareResult {
  double rest_expected = 0, rest_found = 0;  ///< of the pool of small bins
  bool tests_rest = false;
};
CoarseChiSquareResult coarse_chi_square_test(std::span<const double> masses,
                                             std::span<const std::size_t> counts, std::size_t trials,
                                             double relative_error, double least_expected = 10,
                                             double least_rest = 5);

}  // namespace aureole
