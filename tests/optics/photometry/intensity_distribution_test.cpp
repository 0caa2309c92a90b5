// SPDX-License-Identifier: Apache-2.0
// Tables of luminous intensities: directions of the three types, interpolation, and the integral. The references are
// closed forms and sums over directions that are written here anew.
#include "aureole/optics/photometry/intensity_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace aureole::optics {
namespace {

constexpr double kRadian = 180 / M_PI;  // degrees

std::vector<double> steps(double from, double to, double step) {
  std::vector<double> all;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) all.push_back(from + i * step);
  return all;
}

TEST(IntensityDistribution, IntegralsOfClosedForms) {
  const PhotometricAxes c = photometric_axes(PhotometricType::c);
  // Isotropic: 4 pi I. Two angles are enough, for the intensities are linear between them.
  EXPECT_NEAR(IntensityDistribution(c, {0}, {0, 180}, {100, 100}).flux(), 400 * M_PI, 1e-9);
  EXPECT_NEAR(IntensityDistribution(c, {0, 120, 360}, {0, 180}, {100, 100, 100, 100, 100, 100}).flux(),
              400 * M_PI, 1e-9);
  // I = angle/pi: the integral of x sin(x) over [0, pi] is pi, so that the flux is 2 pi.
  EXPECT_NEAR(IntensityDistribution(c, {0}, {0, 180}, {0, 1}).flux(), 2 * M_PI, 1e-12);
  // A Lambertian lamp: pi I, less the error of chords in place of the cosine, h^2/12 of it with h in radians.
  std::vector<double> polar = steps(0, 90, 1), cosine;
  for (const double p : polar) cosine.push_back(1000 * std::cos(p / kRadian));
  const double h = 1 / kRadian, flux = IntensityDistribution(c, {0}, polar, cosine).flux();
  EXPECT_NEAR(flux / (1000 * M_PI), 1 - h * h / 12, 1e-8);
  // The part between two polar angles, also where these are no angles of the table.
  const IntensityDistribution lamp(c, {0}, polar, cosine);
  EXPECT_NEAR(lamp.flux(0, 30.5) + lamp.flux(30.5, 180), flux, 1e-9);
  EXPECT_NEAR(lamp.flux(0, 30) / (1000 * M_PI), 0.25, 1e-4);
}

TEST(IntensityDistribution, ANarrowCellKeepsItsFlux) {
  // Angles 1e-4 degrees apart: differences of cosines would have no digits left.
  const PhotometricAxes c = photometric_axes(PhotometricType::c);
  const IntensityDistribution d(c, {0}, {50, 50.0001}, {2, 4});
  const double width = 1e-4 / kRadian;
  EXPECT_NEAR(d.flux() / (2 * M_PI * 3 * std::sin(50.00005 / kRadian) * width), 1, 1e-7);
}

/// The intensity of a lobe about a direction, which no system of coordinates prefers.
double lobe(const LuminaireVector& d) {
  const double l = std::sqrt(1 + 0.25 + 4.0);
  const double cosine = (d[0] * 1 + d[1] * 0.5 + d[2] * 2) / l;
  return cosine > 0 ? 500 * cosine * cosine * cosine : 0;
}

/// The directions of a headlamp, a floodlight and a room's luminaire, written anew.
LuminaireVector direction_a(double h, double v) {  // rises by v, then turns to the right by h
  return {-std::cos(v) * std::sin(h), std::sin(v), std::cos(v) * std::cos(h)};
}
LuminaireVector direction_b(double h,
                            double v) {  // turns about the horizontal axis by v, then leaves the plane by h
  return {-std::sin(h), std::cos(h) * std::sin(v), std::cos(h) * std::cos(v)};
}
LuminaireVector direction_c(double c, double gamma) {
  return {std::sin(gamma) * std::cos(c), -std::sin(gamma) * std::sin(c), std::cos(gamma)};
}

TEST(IntensityDistribution, AllTypesDescribeOneLobe) {
  const auto make = [](PhotometricType type, const auto& direction_of) {
    const bool is_c = type == PhotometricType::c;
    const std::vector<double> azimuths = is_c ? steps(0, 360, 2) : steps(-180, 180, 2),
                              polar = steps(0, 180, 1);
    std::vector<double> cd;
    for (const double a : azimuths)
      for (const double p : polar) cd.push_back(lobe(direction_of(a / kRadian, p / kRadian)));
    return IntensityDistribution(photometric_axes(type), azimuths, polar, cd);
  };
  // The polar angle of A is 90 degrees minus the vertical angle, that of B minus the horizontal one.
  const IntensityDistribution all[] = {
      make(PhotometricType::a, [](double a, double p) { return direction_a(a, M_PI / 2 - p); }),
      make(PhotometricType::b, [](double a, double p) { return direction_b(M_PI / 2 - p, a); }),
      make(PhotometricType::c, [](double a, double p) { return direction_c(a, p); })};
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    LuminaireVector d{normal(random), normal(random), normal(random)};
    const double l = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (double& x : d) x /= l;
    for (const IntensityDistribution& distribution : all)
      largest = std::max(largest, std::abs(distribution.intensity(d) - lobe(d)));
  }
  EXPECT_LT(largest, 0.5);  // of 500: the error of chords
  // The integral of cos^3 over a hemisphere is pi/2.
  for (const IntensityDistribution& distribution : all) {
    EXPECT_NEAR(distribution.flux(), 250 * M_PI, 0.0006 * 250 * M_PI);
    EXPECT_NEAR(distribution.maximum(), 500, 0.2);
  }
}

TEST(IntensityDistribution, HalfPlanesMeetAtTheSeamAndEndAtTheirLimits) {
  const PhotometricAxes c = photometric_axes(PhotometricType::c);
  const IntensityDistribution d(c, {0, 90, 180, 270, 360}, {0, 90}, {1, 10, 1, 20, 1, 30, 1, 40, 1, 10});
  EXPECT_NEAR(d.at(359, 90), 10 + 30.0 / 90, 1e-12);
  EXPECT_NEAR(d.at(-1, 90), 10 + 30.0 / 90, 1e-12);
  EXPECT_NEAR(d.at(45, 45), 8, 1e-12);
  EXPECT_EQ(d.at(45, 90.001), 0);                  // dark beyond the last angle
  EXPECT_NEAR(d.intensity({0, -1, 0}), 20, 1e-9);  // C = 90
  EXPECT_NEAR(d.intensity({1, 0, 0}), 10, 1e-9);
  EXPECT_NEAR(d.widest_angle(), M_PI / 2, 1e-12);
  const IntensityDistribution a(photometric_axes(PhotometricType::a), {-30, 30}, {60, 120}, {5, 5, 5, 5});
  EXPECT_EQ(a.at(31, 90), 0);
  EXPECT_EQ(a.at(-31, 90), 0);
  EXPECT_EQ(a.at(0, 59), 0);
  EXPECT_EQ(a.at(0, 90), 5);
}

TEST(IntensityDistribution, WrongTablesAreErrors) {
  const PhotometricAxes c = photometric_axes(PhotometricType::c);
  EXPECT_THROW(IntensityDistribution(c, {}, {0, 90}, {}), std::domain_error);
  EXPECT_THROW(IntensityDistribution(c, {0}, {0, 90}, {1}), std::domain_error);
  EXPECT_THROW(IntensityDistribution(c, {0}, {90, 0}, {1, 1}), std::domain_error);
  EXPECT_THROW(IntensityDistribution(c, {0}, {0, 181}, {1, 1}), std::domain_error);
  EXPECT_THROW(IntensityDistribution(c, {0}, {0, 90}, {1, -1}), std::domain_error);
  EXPECT_THROW(IntensityDistribution(c, {0}, {0, 90}, {1, NAN}), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
