// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/block_average.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aureole::optics {
namespace {

TEST(BlockAverage, KnowsCorrelatedSeries) {
  // x' = c x + noise has the integrated autocorrelation time (1 + c)/(1 - c).
  for (const double c : {0.0, 0.6, 0.9}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    double chi_squared = 0, time = 0;
    const int runs = 200;
    for (int run = 0; run < runs; ++run) {
      BlockAverage a, b;
      double x = normal(random) / std::sqrt(1 - c * c);
      for (int i = 0; i < 2000; ++i) {
        if (i == 1000) x = normal(random) / std::sqrt(1 - c * c);  // b is independent of a
        (i < 1000 ? a : b).add(x);
        x = c * x + normal(random);
      }
      a.merge(b);
      EXPECT_EQ(a.count(), 2000);
      chi_squared += a.mean() * a.mean() / (a.error() * a.error()) / runs;
      time += a.correlation_time() / runs;
    }
    EXPECT_GT(chi_squared, 0.7) << c;
    EXPECT_LT(chi_squared, 1.5) << c;
    EXPECT_NEAR(time / ((1 + c) / (1 - c)), 1, 0.3) << c;
  }
}

}  // namespace
}  // namespace aureole::optics
