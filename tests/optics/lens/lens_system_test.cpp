// SPDX-License-Identifier: Apache-2.0
// Lenses against matrices of first order, closed forms and searches along rays.
#include "aureole/optics/lens/lens_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace aureole::optics {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

LensSurface surface(double radius, double thickness, double semi, bool is_stop = false) {
  LensSurface s;
  s.curvature = radius == 0 ? 0 : 1 / radius;
  s.thickness = thickness, s.semi_diameter = semi, s.is_stop = is_stop;
  return s;
}
/// A Cooke triplet with constant indices.
LensSystem triplet() {
  return LensSystem({surface(22.01359, 3.258956, 9.5), surface(-435.76044, 6.007551, 9.5),
                     surface(-22.21328, 0.999975, 5), surface(20.29192, 4.750409, 5, true),
                     surface(79.6836, 2.952076, 7.5), surface(-18.39533, 42.2078, 7.5)});
}
const std::vector<double> kTriplet{1.62041, 1, 1.62004, 1, 1.62041, 1};

TEST(LensSystem, FirstOrderByMatricesOfHeightsAndAngles) {
  // Matrices that act on heights and angles in their medium, not on reduced angles.
  const LensSystem lens = triplet();
  double m[2][2] = {{1, 0}, {0, 1}}, n = 1;
  const auto apply = [&](double a, double b, double c, double d) {
    for (int k = 0; k < 2; ++k) {
      const double top = a * m[0][k] + b * m[1][k], bottom = c * m[0][k] + d * m[1][k];
      m[0][k] = top, m[1][k] = bottom;
    }
  };
  for (std::size_t i = 0; i < lens.surfaces().size(); ++i) {
    const LensSurface& s = lens.surfaces()[i];
    const double next = kTriplet[i];
    apply(1, 0, (n - next) * s.curvature / next, n / next);
    n = next;
    if (i + 1 < lens.surfaces().size()) apply(1, s.thickness, 0, 1);
  }
  const ParaxialLens p = lens.paraxial(kTriplet);
  EXPECT_NEAR(p.focal_length, -1 / m[1][0], 1e-9);
  EXPECT_NEAR(p.focal_length, 50, 0.05);
  EXPECT_NEAR(p.back_focus - lens.vertex(5), -m[0][0] / m[1][0], 1e-9);
  EXPECT_NEAR(p.front_focus, m[1][1] / m[1][0], 1e-9);
  EXPECT_NEAR(lens.paraxial_image(kTriplet, kInfinite), p.back_focus, 1e-9);
  // Newton's equation: the distances from the focal points multiply to the squared focal length.
  const double object = 700;
  EXPECT_NEAR((object + p.front_focus) * (lens.paraxial_image(kTriplet, object) - p.back_focus),
              p.focal_length * p.focal_length, 1e-6);
}

TEST(LensSystem, RaysNearTheAxisAreParaxial) {
  const LensSystem lens = triplet();
  const ParaxialLens p = lens.paraxial(kTriplet);
  LensRay ray{{0, 1e-4, -10}, {0, 0, 1}};
  ASSERT_TRUE(lens.trace(ray, kTriplet, 550));
  EXPECT_NEAR(ray.o[2] - ray.o[1] * ray.d[2] / ray.d[1], p.back_focus, 1e-6);
  // A ray aimed at the middle of the entrance pupil passes the middle of the stop, and leaves from the exit pupil.
  LensRay chief{{0, 0, p.entrance_pupil}, {0, 1e-4, 1}};
  const double norm = std::hypot(1e-4, 1.0);
  for (double& x : chief.d) x /= norm;
  for (std::size_t k = 0; k < 3; ++k) chief.o[k] -= 30 * chief.d[k];
  ASSERT_TRUE(lens.trace(chief, kTriplet, 550));
  EXPECT_NEAR(chief.o[2] - chief.o[1] * chief.d[2] / chief.d[1], p.exit_pupil, 1e-5);
}

TEST(LensSystem, RaysRunBackTheWayTheyCame) {
  const LensSystem lens = triplet();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> within(-4, 4), angle(-0.3, 0.3);
  int passed = 0;
  for (int i = 0; i < 2000; ++i) {
    LensRay there{{within(random), within(random), -5}, {angle(random), angle(random), 1}};
    const double norm = std::hypot(there.d[0], there.d[1], 1.0);
    for (double& x : there.d) x /= norm;
    LensRay ray = there;
    const auto t = lens.trace(ray, kTriplet, 550);
    if (!t) continue;
    ++passed;
    for (double& x : ray.d) x = -x;
    const auto back = lens.trace_back(ray, kTriplet, 550);
    ASSERT_TRUE(back);
    EXPECT_NEAR(*back, *t, 1e-12);
    const double along = (there.o[2] - ray.o[2]) / ray.d[2];
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(ray.d[k], -there.d[k], 1e-11);
      EXPECT_NEAR(ray.o[k] + ray.d[k] * along, there.o[k], 1e-9);
    }
  }
  EXPECT_GT(passed, 300);
}

TEST(LensSystem, AHyperboloidFocusesParallelLightIntoAPoint) {
  // Conic constant -n^2 behind a plane: a point image at R/(n - 1) for all heights.
  LensSurface back = surface(-25, 50, 10);
  back.conic = -2.25;
  const LensSystem lens({surface(0, 5, 10, true), back});
  const std::vector<double> n{1.5, 1};
  const Spot spot = object_spot(lens, n, 550, 0, kInfinite, 60);
  EXPECT_GT(spot.points.size(), 1000u);
  EXPECT_LT(spot.rms_radius, 1e-10);
  EXPECT_NEAR(best_focus(lens, n, 550, kInfinite), lens.film(), 1e-8);
  // A sphere in its place has spherical aberration: the marginal ray focuses shorter.
  const LensSystem sphere({surface(0, 5, 10, true), surface(-25, 50, 10)});
  EXPECT_GT(object_spot(sphere, n, 550, 0, kInfinite, 60).rms_radius, 0.1);
  EXPECT_LT(best_focus(sphere, n, 550, kInfinite), sphere.paraxial_image(n, kInfinite) - 1);
}

TEST(LensSystem, SpotsOfNearPointsHaveTheParaxialMagnification) {
  // A singlet in air by the formulae of thick lenses, its stop behind it.
  const double n = 1.5168, first = 50, second = -80, thickness = 8, object = 200, field = 0.01;
  LensSystem lens({surface(first, thickness, 10), surface(second, 60, 2, true)});
  const double power = (n - 1) * (1 / first - 1 / second + (n - 1) * thickness / (n * first * second)),
               focal = 1 / power, front = -focal * (n - 1) * thickness / (n * second),
               rear = -focal * (n - 1) * thickness / (n * first);
  const double from_principal = object + front, image = 1 / (power - 1 / from_principal);
  lens.set_film(thickness + rear + image);
  const std::vector<double> indices{n, 1};
  // The stop seen through the lens: by the first surface, from the second one backwards.
  const double pupil = 1 / (n / thickness - (n - 1) / first), below = (object + pupil) * std::tan(field);
  const Spot spot = object_spot(lens, indices, 550, field, object, 60);
  EXPECT_GT(spot.points.size(), 1000u);
  EXPECT_NEAR(spot.centroid[1], image / from_principal * below, 2e-3 * below);
  EXPECT_NEAR(spot.centroid[0], 0, 1e-9);
  EXPECT_LT(spot.rms_radius, 0.02);
  // In the focus of distant points the same point is a disc: the stop's, as wide as the focus is away.
  lens.set_film(thickness + rear + focal);
  const double defocus = image - focal, distance = rear + image;  // of the image from the stop
  EXPECT_NEAR(object_spot(lens, indices, 550, 0, object, 60).rms_radius,
              2 / std::sqrt(2) * defocus / distance, 0.03);
}

TEST(LensSystem, AspheresAreMetWhereASearchAlongTheRayFindsThem) {
  LensSurface s = surface(30, 40, 9, true);
  s.conic = -0.6, s.even = {3e-6, -2e-8, 1e-10};
  const LensSystem lens({s});
  const std::vector<double> n{1};  // no refraction: the ray stays straight
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-6, 6), angle(-0.4, 0.4);
  for (int i = 0; i < 300; ++i) {
    LensRay ray{{within(random), within(random), -4}, {angle(random), angle(random), 1}};
    const double norm = std::hypot(ray.d[0], ray.d[1], 1.0);
    for (double& x : ray.d) x /= norm;
    const LensRay start = ray;
    if (!lens.trace(ray, n, 550)) continue;
    const auto above = [&](double t) {
      const double x = start.o[0] + start.d[0] * t, y = start.o[1] + start.d[1] * t,
                   z = start.o[2] + start.d[2] * t;
      const double r2 = x * x + y * y, c = 1 / 30.0;
      return z - (c * r2 / (1 + std::sqrt(1 - 0.4 * c * c * r2)) + 3e-6 * r2 * r2 - 2e-8 * r2 * r2 * r2 +
                  1e-10 * r2 * r2 * r2 * r2);
    };
    double low = 0, high = 20;
    ASSERT_LT(above(low), 0);
    for (int step = 0; step < 100; ++step) (above(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    EXPECT_NEAR((ray.o[2] - start.o[2]) / start.d[2], low, 1e-9);
  }
}

TEST(LensSystem, ChromaticFocusOfASingletFollowsItsAbbeNumber) {
  // A thin lens of BK7 of about 100 mm: f_C - f_F is nearly f/V, and exactly so by the indices.
  const LensSystem lens({surface(103.36, 1e-6, 5, true), surface(-103.36, 100, 5)});
  const auto focal = [&](double index) { return lens.paraxial(std::vector<double>{index, 1}).focal_length; };
  const double d = focal(1.516800), f = focal(1.522379), c = focal(1.514322);
  EXPECT_NEAR(d, 100, 0.01);
  EXPECT_NEAR(c - f, 103.36 / 2 * (1 / 0.514322 - 1 / 0.522379), 1e-4);
  EXPECT_NEAR(c - f, d / 64.17, 0.01 * d / 64.17);
}

TEST(LensSystem, CoatingsAtNormalIncidence) {
  // Fresnel: 4 n/(n + 1)^2; a quarter wave of index n1 leaves ((n - n1^2)/(n + n1^2))^2; an index of sqrt(n) nothing.
  EXPECT_NEAR(coated_transmittance(1, 1.5, 1, 0, 550, 550), 0.96, 1e-12);
  EXPECT_NEAR(coated_transmittance(1, 1.5, 1, 1.38, 550, 550),
              1 - std::pow((1.5 - 1.38 * 1.38) / (1.5 + 1.38 * 1.38), 2), 1e-12);
  EXPECT_NEAR(coated_transmittance(1.69, 1, 1, 1.3, 500, 500), 1, 1e-12);
  // At half the design wavelength the layer is a half wave and does nothing.
  EXPECT_NEAR(coated_transmittance(1, 1.5, 1, 1.38, 550, 275), 0.96, 1e-9);
  EXPECT_EQ(coated_transmittance(1, 1.5, 0.3, 1, 550, 550), 1);
  // Brewster's angle: all of one polarisation passes.
  const double brewster = std::cos(std::atan(1.5)), rs = (1 - 1.5 * 1.5) / (1 + 1.5 * 1.5);
  EXPECT_NEAR(coated_transmittance(1, 1.5, brewster, 0, 550, 550), 1 - 0.5 * rs * rs, 1e-12);
  EXPECT_EQ(coated_transmittance(1.5, 1, 0.5, 0, 550, 550), 0);  // total reflection
}

TEST(LensSystem, StopsOfBlades) {
  LensSystem lens({surface(50, 40, 12), surface(0, 1, 10, true)});
  const std::vector<double> n{1.0, 1.0};
  const auto open = [&] {
    int count = 0;
    for (int i = 0; i < 400; ++i)
      for (int j = 0; j < 400; ++j) {
        LensRay ray{{(i - 199.5) * 0.055, (j - 199.5) * 0.055, -5}, {0, 0, 1}};
        count += lens.trace(ray, n, 550).has_value();
      }
    return count * 0.055 * 0.055;
  };
  EXPECT_NEAR(open(), M_PI * 100, 1);
  lens.set_blades(6, 0.2);
  EXPECT_NEAR(open(), 3 * std::sqrt(3.0) / 2 * 100, 1);
}

TEST(LensSystem, WhatIsNoLens) {
  const auto wrong = [](std::vector<LensSurface> s) {
    EXPECT_THROW(LensSystem(std::move(s)), std::domain_error);
  };
  wrong({});
  wrong({surface(50, 1, 5)});
  wrong({surface(50, 1, 5, true), surface(-50, 1, 5, true)});
  wrong({surface(50, 1, 0, true)});
  wrong({surface(4, 1, 5, true)});
  wrong({surface(NAN, 1, 5, true)});
  EXPECT_THROW(LensSystem({surface(0, 1, 5, true)}).paraxial(std::vector<double>{1.5}), std::domain_error);
  // A last surface so small that no light reaches it.
  EXPECT_THROW(best_focus(LensSystem({surface(50, 5, 10, true), surface(-50, 40, 1e-6)}),
                          std::vector<double>{1.5, 1}, 550, kInfinite),
               std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
