// SPDX-License-Identifier: Apache-2.0
// Solid angles against quadrature over the surfaces and against closed forms on the axis.
#include "aureole/optics/photometry/solid_angle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace aureole::optics {
namespace {

/// Solid angles of a parallelogram of `corner` + a u + b v by midpoints.
SolidAngles by_midpoints(const Point3& corner, const Point3& u, const Point3& v, const Point3& normal) {
  constexpr int kSide = 1500;
  const Point3 across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  SolidAngles sum;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      Point3 p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = corner[k] + u[k] * (i + 0.5) / kSide + v[k] * (j + 0.5) / kSide;
      const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2], distance = std::sqrt(square);
      const double part = std::abs(p[0] * across[0] + p[1] * across[1] + p[2] * across[2]) /
                          (square * distance * kSide * kSide);
      sum.solid += part;
      sum.projected +=
          part * std::max(0.0, (p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2]) / distance);
    }
  return sum;
}

TEST(SolidAngle, Polygons) {
  const Point3 normal{0, 0, 1};
  const Point3 corner{0.5, -1, -0.7}, u{0.3, 2, 0.2}, v{0.1, -0.2, 2.1};
  std::vector<Point3> corners{corner, corner, corner, corner};
  for (std::size_t k = 0; k < 3; ++k)
    corners[1][k] += u[k], corners[2][k] += u[k] + v[k], corners[3][k] += v[k];
  const SolidAngles found = polygon_solid_angle(corners, normal),
                    expected = by_midpoints(corner, u, v, normal);
  EXPECT_NEAR(found.solid, expected.solid, 1e-5);
  EXPECT_NEAR(found.projected, expected.projected, 1e-5);
  // The roof hole of a daylight problem: 4 x 4 m, 3 m up, a fraction 0.357685 of the sky's illuminance.
  const std::vector<Point3> roof{{-2, -2, 3}, {2, -2, 3}, {2, 2, 3}, {-2, 2, 3}};
  EXPECT_NEAR(polygon_solid_angle(roof, normal).projected / M_PI, 0.357685, 5e-7);
  // Below the horizon nothing is left.
  const std::vector<Point3> floor{{-2, -2, -3}, {2, -2, -3}, {2, 2, -3}};
  EXPECT_EQ(polygon_solid_angle(floor, normal).projected, 0);
  EXPECT_GT(polygon_solid_angle(floor, normal).solid, 0.1);
}

TEST(SolidAngle, DiscsAndSpheresOnTheAxis) {
  for (const double d : {0.01, 0.5, 2.0, 1e4}) {
    const SolidAngles disc = disc_solid_angle({0, 0, d}, {0, 0, -3}, 1, {0, 0, 2});
    EXPECT_NEAR(disc.solid, 2 * M_PI / ((1 + d * d) * (1 + d / std::hypot(1, d))), 1e-9);
    EXPECT_NEAR(disc.projected, M_PI / (1 + d * d), 1e-9);
    const SolidAngles sphere = sphere_solid_angle({0, 0, d + 1}, 1, {0, 0, 1});
    EXPECT_NEAR(sphere.projected, M_PI / ((d + 1) * (d + 1)), 1e-9);
  }
  // A sphere halfway under the horizon, from its middle's height: half of its projected solid angle is that of a cap that the plane halves.
  const SolidAngles half = sphere_solid_angle({2, 0, 0}, 1, {0, 0, 1});
  double expected = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      // Directions (x, y, z) with z = sin(elevation); within the cone of 30 degrees about x.
      const double z = (i + 0.5) / kSteps * 0.5, phi = ((j + 0.5) / kSteps - 0.5) * M_PI / 3 * 1.001;
      if (std::sqrt(1 - z * z) * std::cos(phi) > std::sqrt(0.75))
        expected += z * 0.5 / kSteps * M_PI / 3 * 1.001 / kSteps;
    }
  EXPECT_NEAR(half.projected, expected, 1e-4);
  EXPECT_EQ(sphere_solid_angle({0.5, 0, 0}, 1, {0, 0, 1}).solid, 4 * M_PI);
}

TEST(SolidAngle, MistakesAreErrors) {
  EXPECT_THROW(sphere_solid_angle({0, 0, 1}, 0, {}), std::domain_error);
  EXPECT_THROW(disc_solid_angle({0, 0, 1}, {0, 0, 0}, 1, {}), std::domain_error);
  EXPECT_THROW(disc_solid_angle({0, 0, NAN}, {0, 0, 1}, 1, {}), std::domain_error);
  const std::vector<Point3> two{{0, 0, 1}, {1, 0, 1}};
  EXPECT_THROW(polygon_solid_angle(two, {}), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
