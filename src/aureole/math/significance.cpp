// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/significance.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <vector>

#include "aureole/core/random.h"

namespace aureole {

double sidak_level(double family, std::size_t tests) {
  return -std::expm1(std::log1p(-family) / double(tests));
}

double chi_square_p_value(double statistic, std::size_t degrees_of_freedom) {
  return degrees_of_freedom ? boost::math::gamma_q(0.5 * double(degrees_of_freedom), 0.5 * statistic) : 1;
}

double binomial_p_value(std::size_t count, std::size_t trials, double probability) {
  if (probability <= 0) return count == 0 ? 1 : 0;
  if (probability >= 1) return count == trials ? 1 : 0;
  const boost::math::binomial_distribution<> b(double(trials), probability);
  const double at_most = cdf(b, double(count));
  const double at_least = count == 0 ? 1 : cdf(complement(b, double(count) - 1));
  return std::min(1.0, 2 * std::min(at_most, at_least));
}

double normal_p_value(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

float SeededRandom::next() { return unit_float(std::uint32_t(combine_bits(seed_, counter_++) >> 32)); }

ChiSquareResult chi_square_test(std::span<const double> masses, std::span<const std::size_t> counts,
                                std::size_t trials, double least_expected) {
  struct Pool {
    double expected = 0, found = 0;
  };
  std::vector<Pool> pools(1);
  ChiSquareResult result;
  const double n = double(trials);
  double mass = 0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double m = masses[i];
    mass += m;
    inside += counts[i];
    if (pools.back().expected >= least_expected) pools.emplace_back();
    pools.back().expected += n * m;
    pools.back().found += double(counts[i]);
  }
  if (pools.size() > 1 && pools.back().expected < least_expected) {
    const Pool last = pools.back();
    pools.pop_back();
    pools.back().expected += last.expected;
    pools.back().found += last.found;
  }
  // Samples elsewhere (other lobes, or none) form one more pool, if it is larger than the quadrature error.
  const double outside = n * (1 - mass);
  if (outside >= least_expected || inside < trials)
    pools.push_back({std::max(outside, 1e-3), double(trials - inside)});
  for (const Pool& p : pools) {
    if (p.expected > 0) result.statistic += (p.found - p.expected) * (p.found - p.expected) / p.expected;
  }
  result.bins = pools.size();
  result.p_value = chi_square_p_value(result.statistic, pools.size() - 1);
  return result;
}

CoarseChiSquareResult coarse_chi_square_test(std::span<const double> masses,
                                             std::span<const std::size_t> counts, std::size_t trials,
                                             double relative_error, double least_expected,
                                             double least_rest) {
  CoarseChiSquareResult result;
  const double n = double(trials);
  const auto add = [&](double expected, double found) {
    const double error = relative_error * expected;
    result.statistic += (found - expected) * (found - expected) / (expected + error * error);
    ++result.bins;
  };
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double expected = masses[i] * n;
    if (expected >= least_expected) {
      add(expected, double(counts[i]));
    } else {
      result.rest_expected += expected, result.rest_found += double(counts[i]);
    }
  }
  result.tests_rest = result.rest_expected > least_rest;
  if (result.tests_rest) add(result.rest_expected, result.rest_found);
  if (result.bins >= 2) result.p_value = chi_square_p_value(result.statistic, result.bins - 1);
  return result;
}

}  // namespace aureole
