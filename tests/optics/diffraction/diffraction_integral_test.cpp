// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/diffraction_integral.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/diffraction/edge_wave.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
using testing::regular_ring;

constexpr double k = 2 * M_PI;  // lengths in wavelengths
const ScreenSource kNormal = ScreenSource::plane_wave({0, 0, 1});

/// On the axis of a disc, both integrals are closed: the wave through the middle less that from the rim.
Complex rim(double a, double z) { return std::polar(z / std::hypot(a, z), k * std::hypot(a, z)); }

TEST(DiffractionIntegral, RayleighSommerfeldOnTheAxisOfADisc) {
  double worst = 0;
  for (double a : {0.7, 5.0, 20.0})
    for (double z : {0.3, 2.0, 17.0, 300.0}) {
      const Complex exact = std::polar(1.0, k * z) - rim(a, z);
      worst =
          std::max(worst, std::abs(rayleigh_sommerfeld(FlatOpening::disc(a), kNormal, {0, 0, z}, k) - exact));
    }
  std::printf("Rayleigh-Sommerfeld on the axis of discs: error %.1e\n", worst);
  EXPECT_LT(worst, 1e-8);
  // A ring: the same between two rims.
  EXPECT_LT(
      std::abs(rayleigh_sommerfeld(FlatOpening::disc(5, 2), kNormal, {0, 0, 9}, k) - (rim(2, 9) - rim(5, 9))),
      1e-8);
}

TEST(DiffractionIntegral, KirchhoffOnTheAxisOfADisc) {
  for (double a : {0.7, 5.0})
    for (double z : {2.0, 17.0}) {
      const double r = std::hypot(a, z);
      const Complex exact = std::polar(1.0, k * z) - 0.5 * (1 + z / r) * std::polar(1.0, k * r);
      EXPECT_LT(std::abs(kirchhoff(FlatOpening::disc(a), kNormal, {0, 0, z}, k) - exact), 1e-8);
      // From a point: the boundary wave of Maggi and Rubinowicz (Born & Wolf 1999, 8.9), gamma the angle of the turn at the rim.
      const double s = 6, rho = std::hypot(a, s), gamma = std::atan(a / s) + std::atan(a / z);
      const Complex from_point = std::polar(1 / (s + z), k * (s + z)) -
                                 0.5 * a / std::tan(0.5 * gamma) / (rho * r) * std::polar(1.0, k * (rho + r));
      EXPECT_LT(std::abs(kirchhoff(FlatOpening::disc(a), ScreenSource::point({0, 0, -s}), {0, 0, z}, k) -
                         from_point),
                1e-8);
    }
}

// Everything turned about the axis: other rows, other cells, the same field.
TEST(DiffractionIntegral, DoesNotDependOnTheFrame) {
  Ring star, turned;
  const double c = std::cos(0.4), s = std::sin(0.4);
  for (int i = 0; i < 10; ++i)
    star.push_back({(i % 2 ? 1 : 3) * std::sin(i * M_PI / 5), (i % 2 ? 1 : 3) * std::cos(i * M_PI / 5)});
  for (const PlanePoint& p : star) turned.push_back({c * p.x - s * p.y, s * p.x + c * p.y});
  const auto first = FlatOpening::polygon(PolygonRegion::even_odd({star})),
             second = FlatOpening::polygon(PolygonRegion::even_odd({turned}));
  const double x = 2, y = -1, z = 6;
  const auto point = ScreenSource::point({-1, 0, -5}), point_turned = ScreenSource::point({-c, -s, -5});
  EXPECT_LT(std::abs(rayleigh_sommerfeld(first, point, {x, y, z}, k) -
                     rayleigh_sommerfeld(second, point_turned, {c * x - s * y, s * x + c * y, z}, k)),
            1e-9);
  const auto wave = ScreenSource::plane_wave({0.3, 0.1, 0.9}),
             wave_turned = ScreenSource::plane_wave({0.3 * c - 0.1 * s, 0.3 * s + 0.1 * c, 0.9});
  EXPECT_LT(std::abs(kirchhoff(first, wave, {x, y, z}, k) -
                     kirchhoff(second, wave_turned, {c * x - s * y, s * x + c * y, z}, k)),
            1e-9);
}

TEST(DiffractionIntegral, FraunhoferOfADiscIsAirysPattern) {
  for (double q : {0.0, 0.4, 3.0, 30.0})
    EXPECT_NEAR(
        std::abs(fraunhofer(FlatOpening::disc(2), {0.6 * q, 0.8 * q}) - circle_aperture_transform(q, 2)), 0,
        1e-8);
  EXPECT_NEAR(std::abs(fraunhofer(FlatOpening::disc(2, 1), {0.6, 0.8}) - circle_aperture_transform(1, 2) +
                       circle_aperture_transform(1, 1)),
              0, 1e-8);
}

// Edge waves are Fraunhofer's integral; this is how far from an opening they hold.
TEST(DiffractionIntegral, HowFarEdgeWavesHold) {
  const Ring square{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
  const auto region = PolygonRegion::even_odd({square});
  const auto edges = region_edges(region);
  double before = INFINITY;
  for (double distance : {25.0, 100.0, 400.0, 1600.0}) {
    double wrong = 0, right = 0;
    for (int i = 1; i < 12; ++i) {
      const double theta = 0.037 * i, phi = 0.3;
      const Complex exact =
          rayleigh_sommerfeld(FlatOpening::polygon(region), kNormal,
                              {distance * std::sin(theta) * std::cos(phi),
                               distance * std::sin(theta) * std::sin(phi), distance * std::cos(theta)},
                              k);
      const double edge = std::norm(edge_field(edges, {k * std::sin(theta) * std::cos(phi),
                                                       k * std::sin(theta) * std::sin(phi)})) /
                          (distance * distance);
      wrong += std::pow(edge - std::norm(exact), 2), right += std::pow(std::norm(exact), 2);
    }
    const double error = std::sqrt(wrong / right);
    std::printf(
        "square of 10 wavelengths, %5g behind it (half side^2/(lambda R) = %.3f): intensity off by %.3f (rms, 2 to 23 degrees)\n",
        distance, 25 / distance, error);
    EXPECT_LT(error, before);
    before = error;
  }
  EXPECT_LT(before, 0.1);
}

TEST(DiffractionIntegral, SaysWhatIsWrong) {
  EXPECT_THROW(FlatOpening::disc(1, 2), std::domain_error);
  EXPECT_THROW(ScreenSource::point({0, 0, 1}), std::domain_error);
  EXPECT_THROW(ScreenSource::plane_wave({1, 0, 0}), std::domain_error);
  EXPECT_THROW(rayleigh_sommerfeld(FlatOpening::disc(1), kNormal, {0, 0, 0}, k), std::domain_error);
  EXPECT_THROW(kirchhoff(FlatOpening::disc(1), kNormal, {0, 0, 1}, 0), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
