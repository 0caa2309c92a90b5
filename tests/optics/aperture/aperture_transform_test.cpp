// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/aperture_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

/// Integral of cos(q.x) over a disc by the trapezoidal rule in angle, which converges
/// geometrically for a periodic integrand, and Simpson's rule in radius.
double disc_integral(double q, double radius) {
  const int angles = 512, cells = 4000;
  double sum = 0;
  for (int i = 0; i <= cells; ++i) {
    const double r = radius * i / cells;
    double ring = 0;
    for (int j = 0; j < angles; ++j) ring += std::cos(q * r * std::cos(2 * std::numbers::pi * j / angles));
    const double weight = (i == 0 || i == cells) ? 1 : (i % 2 ? 4 : 2);
    sum += weight * r * ring * 2 * std::numbers::pi / angles;
  }
  return sum * radius / cells / 3;
}

TEST(CircleTransform, IsTheFourierIntegralOfADisc) {
  const double radius = 2.5e-6;
  for (double u : {0.0, 0.03, 0.0499, 0.0501, 1.0, 2.5, 3.8317, 5.1356, 20.0, 100.0}) {
    const double area = std::numbers::pi * radius * radius;
    EXPECT_NEAR(circle_aperture_transform(u / radius, radius) / area,
                disc_integral(u / radius, radius) / area, 2e-9)
        << u;
  }
}

TEST(CircleTransform, SeriesMeetsTheBesselFunction) {
  for (double u : {0.01, 0.05, 0.0499999, 0.11, 7.0, 1000.0})
    EXPECT_NEAR(circle_transform(u), 2 * std::cyl_bessel_j(1.0, u) / u, 2e-15) << u;
  EXPECT_EQ(circle_transform(0), 1);
  EXPECT_EQ(circle_transform(-3), circle_transform(3));
}

TEST(CircleTransform, RingsAndEncircledPower) {
  // Zeros of Airy's pattern, and Parseval: (1/4 pi^2) integral |F|^2 d2q = area, 83.78 % of it in the disc.
  EXPECT_NEAR(circle_transform(3.8317059702075123), 0, 1e-15);
  EXPECT_NEAR(circle_transform(7.0155866698156188), 0, 1e-15);
  double inside = 0, sum = 0;
  const double step = 0.005, end = 2000;
  for (int i = 0; i < int(end / step); ++i) {
    const double u = (i + 0.5) * step, f = circle_transform(u);
    sum += 0.5 * f * f * u * step;
    if (u < 3.8317) inside = sum;
  }
  EXPECT_NEAR(inside, 0.8378, 1e-4);
  EXPECT_NEAR(sum + 2 / (std::numbers::pi * end), 1, 1e-6);
}

TEST(CircleTransform, Errors) {
  EXPECT_THROW(circle_aperture_transform(1, 0), std::domain_error);
  EXPECT_THROW(circle_aperture_transform(1, std::nan("")), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
