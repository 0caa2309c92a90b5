// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/round_aperture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "aureole/optics/aperture/polygon_aperture.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;
using testing::wave_vectors;

PolygonAperture aperture(std::vector<Ring> rings) {
  return PolygonAperture(PolygonRegion::even_odd(std::move(rings)));
}

TEST(RoundAperture, EllipseIsACircleStretched) {
  const EllipseAperture ellipse(2, 0.5), circle(1, 1);
  EXPECT_NEAR(ellipse.area(), M_PI, 1e-15);
  EXPECT_EQ(ellipse.bounding_radius(), 2);
  EXPECT_EQ(EllipseAperture(0.5, 2).bounding_radius(), 2);
  EXPECT_FALSE(ellipse.is_circular());
  EXPECT_TRUE(circle.is_circular());
  Ring polygon = regular_ring(4096, std::sqrt(2 * M_PI / (4096 * std::sin(2 * M_PI / 4096))));
  for (PlanePoint& p : polygon) p.x *= 2, p.y *= 0.5;
  const auto reference = aperture({polygon});
  for (const PlanePoint& q : wave_vectors(0.5)) {
    EXPECT_EQ(ellipse.transform(q.x, q.y), circle.transform(2 * q.x, 0.5 * q.y));
    EXPECT_LT(std::abs(ellipse.transform(q.x, q.y) - reference.transform(q.x, q.y)), 1e-9);
  }
}

TEST(RoundAperture, AnnulusIsADifferenceOfCircles) {
  const AnnulusAperture a(2, 1.5);
  EXPECT_TRUE(a.is_circular());
  EXPECT_EQ(a.bounding_radius(), 2);
  EXPECT_NEAR(a.area(), M_PI * 1.75, 1e-14);
  const int n = 2000;
  const double same_area = std::sqrt(2 * M_PI / (n * std::sin(2 * M_PI / n)));
  const auto reference = aperture({regular_ring(n, 2 * same_area), regular_ring(n, 1.5 * same_area)});
  for (const PlanePoint& q : wave_vectors(1))
    EXPECT_LT(std::abs(a.transform(q.x, q.y) - reference.transform(q.x, q.y)), 1e-8);
  EXPECT_NEAR(std::abs(AnnulusAperture(2, 0).transform(1, 1) - EllipseAperture(2, 2).transform(1, 1)), 0,
              1e-15);
}

TEST(RoundAperture, Errors) {
  EXPECT_THROW(EllipseAperture(0, 1), std::domain_error);
  EXPECT_THROW(EllipseAperture(1, std::nan("")), std::domain_error);
  EXPECT_THROW(AnnulusAperture(1, 1), std::domain_error);
  EXPECT_THROW(AnnulusAperture(1, -0.1), std::domain_error);
  EXPECT_THROW(AnnulusAperture(INFINITY, 1), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
