// SPDX-License-Identifier: Apache-2.0
// The structure factors that are not those of a fluid of hard discs: tables, maps, lattices, stretched
// positions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TabulatedStructureFactor, IsLinearBetweenItsValues) {
  const TabulatedStructureFactor s({1, 2, 4}, {0.5, 1.5, 0.9});
  EXPECT_EQ(s.eval(0), 0.5);
  EXPECT_DOUBLE_EQ(s.eval(1.25), 0.75);
  EXPECT_DOUBLE_EQ(s.eval(-3), 1.2);
  EXPECT_DOUBLE_EQ(s.eval(0, 3), 1.2);
  EXPECT_EQ(s.eval(5), 1);
  EXPECT_THROW(TabulatedStructureFactor({1}, {1}), std::domain_error);
  EXPECT_THROW(TabulatedStructureFactor({2, 1}, {1, 1}), std::domain_error);
  EXPECT_THROW(TabulatedStructureFactor({1, 2}, {1, -1}), std::domain_error);
}

TEST(TabulatedStructureFactor, OfAPairCorrelationIsItsTransform) {
  // g to first order in density: 0 for r < 2, then 1 + Fa/pi times the overlap of two discs of radius 2. Its
  // transform by Simpson's rule with the Bessel function of the standard library.
  const double fa = 0.3;
  const auto excess = [&](double x) {
    return x < 4 ? fa / kPi * (8 * std::acos(x / 4) - x / 2 * std::sqrt(16 - x * x)) : 0.0;
  };
  std::vector<double> r, g;
  for (int i = 0; i <= 1800; ++i) r.push_back(2 + 0.01 * i), g.push_back(1 + excess(r.back()));
  const auto s = TabulatedStructureFactor::from_pair_correlation(r, g, fa);
  double worst = 0;
  for (double u = 0; u < 30; u += 0.25) {
    const int cells = 400;
    double sum = 0;
    for (int i = 0; i <= cells; ++i) {
      const double weight = i == 0 || i == cells ? 1 : i % 2 ? 4 : 2, x = 2.0 * i / cells;
      sum += weight * (excess(2 + x) * (2 + x) * std::cyl_bessel_j(0.0, u * (2 + x)) -
                       x * std::cyl_bessel_j(0.0, u * x));
    }
    worst = std::max(worst, std::abs(s.eval(u) - (1 + 2 * fa * sum * 2 / cells / 3)));
  }
  std::printf("S of a table of g: largest error %.1e\n", worst);
  EXPECT_LT(worst, 1e-3);
}

TEST(MappedStructureFactor, IsSymmetricAndOneOutside) {
  const MappedStructureFactor s({1, 2, 3, 4, 5, 6, 7, 8, 11}, 3, 3, 6);
  EXPECT_DOUBLE_EQ(s.eval(0, 0), 5);
  EXPECT_DOUBLE_EQ(s.eval(4, 4), 5);  // (3 + 7)/2, the pixel at the top right
  EXPECT_DOUBLE_EQ(s.eval(4, -4), 6);
  EXPECT_DOUBLE_EQ(s.eval(-4, 4), 6);
  EXPECT_DOUBLE_EQ(s.eval(2, 1), s.eval(-2, -1));
  EXPECT_EQ(s.eval(7, 0), 1);
  EXPECT_FALSE(s.is_isotropic());
  EXPECT_THROW(MappedStructureFactor({1, -1, 1, 1}, 2, 2, 1), std::domain_error);
}

/// Mean of S' over the ring |u| = constant.
double ring(const StructureFactor& s, double u) {
  const int n = 6000;
  double mean = 0;
  for (int i = 0; i < n; ++i)
    mean += s.eval(u * std::cos(2 * kPi * i / n), u * std::sin(2 * kPi * i / n)) / n;
  return mean;
}

/// S' of a lattice by its sum over pairs: exp(-q^2 sigma^2) exp(-r^2/(2 L^2)) cos(q.r) for every lattice
/// vector, less the transform of the mean density under the same Gaussian.
double lattice_sum(bool hexagonal, double fa, double jitter, double domain, double angle, double ux,
                   double uy) {
  const double most = hexagonal ? kPi / std::sqrt(12.0) : kPi / 4, spacing = 2 * std::sqrt(most / fa);
  const double l = domain * spacing, q2 = ux * ux + uy * uy;
  const double x = ux * std::cos(angle) + uy * std::sin(angle),
               y = uy * std::cos(angle) - ux * std::sin(angle);
  double sum = 0;
  for (int i = -80; i <= 80; ++i)
    for (int j = -80; j <= 80; ++j) {
      const double rx = spacing * (i + (hexagonal ? 0.5 * j : 0)),
                   ry = spacing * j * (hexagonal ? std::sqrt(3.0) / 2 : 1);
      sum += std::exp(-(rx * rx + ry * ry) / (2 * l * l)) * std::cos(x * rx + y * ry);
    }
  sum -= fa / kPi * 2 * kPi * l * l * std::exp(-q2 * l * l / 2);
  const double order = std::exp(-q2 * jitter * jitter * spacing * spacing);
  return 1 - order + order * sum;
}

TEST(LatticeStructureFactor, IsTheSumOverPairs) {
  using Kind = LatticeStructureFactor::Kind;
  for (const bool hexagonal : {true, false})
    for (const double fa : {0.2, 0.6}) {
      const LatticeStructureFactor s(hexagonal ? Kind::hexagonal : Kind::square, fa, 0.07, 2.5, 0.3, false);
      double worst = 0;
      for (double u = 0; u < 12; u += 0.37)
        for (double phi = 0; phi < 3; phi += 0.4)
          worst = std::max(worst, std::abs(s.eval(u * std::cos(phi), u * std::sin(phi)) -
                                           lattice_sum(hexagonal, fa, 0.07, 2.5, 0.3, u * std::cos(phi),
                                                       u * std::sin(phi))));
      EXPECT_LT(worst, 1e-9) << hexagonal << " " << fa;
    }
}

TEST(LatticeStructureFactor, DomainsTurnedAtRandomHaveTheMeanOverTheRing) {
  using Kind = LatticeStructureFactor::Kind;
  for (const Kind kind : {Kind::hexagonal, Kind::square}) {
    const LatticeStructureFactor one(kind, 0.5, 0.1, 3, 0, false), many(kind, 0.5, 0.1, 3, 0, true);
    EXPECT_TRUE(many.is_isotropic());
    for (double u = 0; u < 15; u += 0.21) EXPECT_NEAR(many.eval(u), ring(one, u), 1e-6) << u;
  }
  EXPECT_THROW(LatticeStructureFactor(Kind::square, 0.79, 0.1, 3, 0, true), std::domain_error);
  EXPECT_THROW(LatticeStructureFactor(Kind::square, 0.01, 0.1, 3, 0, true), std::domain_error);
}

TEST(StretchedStructureFactor, ScalesItsAxes) {
  const auto fluid = std::make_shared<PercusYevickStructureFactor>(0.5);
  const StretchedStructureFactor s(fluid, 4, kPi / 6);
  const double c = std::cos(kPi / 6), d = std::sin(kPi / 6);
  for (const double u : {0.0, 1.0, 2.9, 6.0}) {
    EXPECT_NEAR(s.eval(u * c, u * d), fluid->eval(2 * u), 1e-12);
    EXPECT_NEAR(s.eval(-u * d, u * c), fluid->eval(u / 2), 1e-12);
    EXPECT_NEAR(s.eval(u), ring(s, u), 1e-7);
  }
}

}  // namespace
}  // namespace aureole::optics
