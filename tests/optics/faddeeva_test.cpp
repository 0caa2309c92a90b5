// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/faddeeva.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;

/// Integral of f from a to b by Gauss's rule on cells.
template <class F>
Complex quadrature(double a, double b, int cells, const F& f) {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  Complex sum = 0;
  for (int c = 0; c < cells; ++c)
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1})
        sum += 0.5 * Rule::weights()[k] * (b - a) / cells *
               f(a + (b - a) * (c + 0.5 + 0.5 * side * Rule::abscissa()[k]) / cells);
  return sum;
}

// Abramowitz & Stegun 1964, table 7.9.
TEST(Faddeeva, TableOfTheHandbook) {
  EXPECT_NEAR(faddeeva({0, 0.5}).real(), 0.615690, 1e-6);
  EXPECT_NEAR(faddeeva({1, 1}).real(), 0.304744, 1e-6);
  EXPECT_NEAR(faddeeva({1, 1}).imag(), 0.208219, 1e-6);
  EXPECT_NEAR(faddeeva({2, 0}).real(), std::exp(-4), 1e-15);
}

TEST(Faddeeva, GaussianWaveIntegralsAreIntegrals) {
  for (auto [a, b] :
       {std::pair(-1.0, 2.0), {0.3, 0.31}, {-5.0, -0.2}, {1.0, 30.0}, {-40.0, 40.0}, {2.0, -1.0}})
    for (double beta : {0.0, 0.4, -3.0, 12.0}) {
      const double low = std::clamp(a, -7.0, 7.0), high = std::clamp(b, -7.0, 7.0);
      const Complex exact =
          quadrature(low, high, 60, [&](double t) { return std::polar(std::exp(-t * t), 2 * beta * t); });
      EXPECT_LT(std::abs(gaussian_wave_integral(a, b, beta) - exact), 2e-14) << a << " " << b << " " << beta;
    }
}

TEST(Faddeeva, FresnelIntegralsAreIntegrals) {
  for (double v : {-3.0, -1.0, 0.0, 1e-3, 0.7, 1.0, 2.5, 9.0}) {
    const Complex exact = quadrature(0, v, 60, [](double t) { return std::polar(1.0, M_PI / 2 * t * t); });
    EXPECT_LT(std::abs(fresnel_integral(v) - exact), 1e-14) << v;
  }
}

// The first maximum and minimum of the lit side are published (Born & Wolf 1999, 8.7.3: 1.37 and 0.78).
TEST(KnifeEdge, PublishedIntensities) {
  EXPECT_NEAR(knife_edge_intensity(-1), 0.041076, 5e-7);
  EXPECT_NEAR(knife_edge_intensity(0), 0.25, 1e-15);
  EXPECT_NEAR(knife_edge_intensity(1.2172), 1.370443, 5e-7);
  EXPECT_NEAR(knife_edge_intensity(1.8725), 0.778251, 5e-7);
  EXPECT_GT(knife_edge_intensity(1.2172), knife_edge_intensity(1.2));
  EXPECT_LT(knife_edge_intensity(1.8725), knife_edge_intensity(1.89));
  // Deep in the shadow 1/(2 pi^2 v^2), which a difference of Fresnel integrals would lose.
  EXPECT_NEAR(knife_edge_intensity(-1e6) * 2 * std::pow(M_PI * 1e6, 2), 1, 1e-9);
}

}  // namespace
}  // namespace aureole::optics
