// SPDX-License-Identifier: Apache-2.0
// The numbers of docs/diffraction_functions.md: where one model stops and the next one is needed.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/diffraction/diffraction_integral.h"
#include "aureole/optics/diffraction/edge_power.h"
#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/optics/faddeeva.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

double db(double ratio) { return 10 * std::log10(ratio); }

// Diffracted power without phases, 1/(2 pi^2 v^2) of the undisturbed light on both sides of the shadow's boundary, and the direct light on one.
TEST(ModelLimits, OfPowersWithoutPhases) {
  for (double v : {-1.0, -2.0, -3.0, -5.0}) {
    const double error = db(1 / (2 * M_PI * M_PI * v * v) / knife_edge_intensity(v));
    std::printf("shadow of a straight edge, v = %2g: edge operator off by %+.2f dB at %.1f dB\n", v, error,
                db(knife_edge_intensity(v)));
    EXPECT_LT(std::abs(error), v > -2 ? 1.0 : 0.13);
  }
  double before = INFINITY;
  for (double from : {1.0, 2.0, 4.0, 8.0}) {
    double most = 0, mean = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double v = from * std::sqrt(1 + 3.0 * i / kSteps);  // even in the number of fringes, v to 2 v
      const double error = db((1 + 1 / (2 * M_PI * M_PI * v * v)) / knife_edge_intensity(v));
      most = std::max(most, std::abs(error)), mean += error / kSteps;
    }
    std::printf("lit side, v = %g to %g: fringes of up to %.2f dB are missing, mean error %+.3f dB\n", from,
                2 * from, most, mean);
    EXPECT_LT(most, before);
    EXPECT_LT(std::abs(mean), 0.15);
    before = most;
  }
}

// The operator knows no polarisation. Metal does, the more the further light turns; plane waves straight on a half plane.
TEST(ModelLimits, OfLargeAngles) {
  const Wedge screen(2);
  const double k = 2 * M_PI;
  for (double degrees : {2.0, 10.0, 30.0, 60.0}) {
    const double theta = degrees * M_PI / 180, phi = 1.5 * M_PI + theta;
    // K per radian, with q = 2 k sin(theta/2): k/(2 pi q^2).
    const double edge = 1 / (2 * M_PI * k * std::pow(2 * std::sin(theta / 2), 2));
    const double soft = std::norm(screen.keller_coefficient(k, 1, phi, M_PI / 2, false)),
                 hard = std::norm(screen.keller_coefficient(k, 1, phi, M_PI / 2, true));
    std::printf(
        "%2g degrees into the shadow: edge operator %+.2f dB over soft, %+.2f dB over hard, %+.2f dB over the mean of both\n",
        degrees, db(edge / soft), db(edge / hard), db(edge / (0.5 * (soft + hard))));
    EXPECT_LT(std::abs(db(edge / soft)), degrees < 3 ? 0.2 : 8);
    EXPECT_LT(std::abs(db(edge / (0.5 * (soft + hard)))), degrees < 11 ? 0.05 : degrees < 31 ? 0.4 : 1.3);
  }
}

// Scalar integrals guess the field in an opening. How wrong that is shows in the light that their far field has where no direction is:
// of a disc J0^2(ka) + J1^2(ka), what Rayleigh's encircled energy leaves (Born & Wolf 1999, 8.5.2), some 1/(pi k a).
TEST(ModelLimits, OfSmallOpenings) {
  for (double radius : {0.5, 1.0, 3.0, 10.0}) {
    const PolygonRegion disc = PolygonRegion::even_odd({testing::regular_ring(240, radius)});
    const double k = 2 * M_PI,
                 lost = 1 - diffracted_power(region_edges(disc), ZerothOrder::kept(), k) / disc.area();
    std::printf("disc of radius %4.1f wavelengths: %.3f of the light through it has no direction\n", radius,
                lost);
    EXPECT_NEAR(lost,
                std::pow(std::cyl_bessel_j(0, k * radius), 2) + std::pow(std::cyl_bessel_j(1, k * radius), 2),
                0.002);
  }
}

/// UTD with black faces behind an opening with straight edges on which a plane wave falls along z: the light
/// that comes straight, and of each edge that of the place where the way to the observer is perpendicular to it.
std::complex<double> utd_behind(const std::vector<DiffractingEdge>& edges, std::array<double, 3> at,
                                double k) {
  std::complex<double> sum = 0;
  bool is_lit = false;
  for (const DiffractingEdge& e : edges) {
    const double length = std::hypot(e.to.x - e.from.x, e.to.y - e.from.y);
    const PlanePoint t{(e.to.x - e.from.x) / length, (e.to.y - e.from.y) / length},
        to{at[0] - e.from.x, at[1] - e.from.y};
    const double into_opening = t.x * to.y - t.y * to.x;
    if ((e.from.y <= at[1]) != (e.to.y <= at[1]) && into_opening * t.y > 0) is_lit = !is_lit;
    if (const double along = t.x * to.x + t.y * to.y; along < 0 || along > length) continue;
    const double s = std::hypot(into_opening, at[2]);
    sum += Wedge(2).coefficient(k, plane_wave_distance(s, 1), 1, 1.5 * M_PI - std::atan2(into_opening, at[2]),
                                M_PI / 2, {0, 0}) *
           plane_wave_spreading(s) * std::polar(1.0, k * s);
  }
  return is_lit ? sum + std::polar(1.0, k * at[2]) : sum;
}

/// Rms errors of amplitudes, over those of Rayleigh and Sommerfeld's integral.
struct OpeningErrors {
  double edge_waves, utd;
};
/// Along a line from the middle of an opening of that width to its sixth fringe, at `distance` [wavelengths].
OpeningErrors errors_behind(const std::vector<Ring>& rings, double width, double distance) {
  constexpr double k = 2 * M_PI, y = 0.0065;
  const PolygonRegion region = PolygonRegion::even_odd(rings);
  const FlatOpening opening = FlatOpening::polygon(region);
  const auto edges = region_edges(region);
  double sum = 0, waves = 0, utd = 0;
  constexpr int kCount = 160;
  for (int i = 1; i <= kCount; ++i) {
    const double sine = 6 / width * i / kCount, x = distance * sine / std::sqrt(1 - sine * sine),
                 r = std::hypot(x, distance);
    const double exact = std::abs(
        rayleigh_sommerfeld(opening, ScreenSource::plane_wave({0, 0, 1}), {x, y * width, distance}, k));
    waves +=
        std::pow(distance / (r * r) * std::abs(edge_field(edges, {k * sine, k * y * width / r})) - exact, 2);
    utd += std::pow(std::abs(utd_behind(edges, {x, y * width, distance}, k)) - exact, 2);
    sum += exact * exact;
  }
  return {std::sqrt(waves / sum), std::sqrt(utd / sum)};
}

Ring rectangle(double width, double height) {
  return {
      {-width / 2, -height / 2}, {width / 2, -height / 2}, {width / 2, height / 2}, {-width / 2, height / 2}};
}

// UTD takes each edge for an endless one: it is right where edges are long against the first zone of Fresnel, and
// where they are short, it has the light of long ones. Edge waves hold where all of the opening lies well within
// that zone.
TEST(ModelLimits, OfShortEdges) {
  constexpr double kWidth = 20, kDistance = 10000, kZone = 100;
  for (const double length : {0.2, 0.4, 4.0, 8.0}) {
    const OpeningErrors e = errors_behind({rectangle(kWidth, length * kZone)}, kWidth, kDistance);
    std::printf("slit of %.1f x %.1f zones of Fresnel: amplitude of edge waves %.2g off, of UTD %.2g\n",
                kWidth / kZone, length, e.edge_waves, e.utd);
    if (length < 1) {
      EXPECT_LT(e.edge_waves, 0.01) << length;
      EXPECT_GT(e.utd, 1) << length;
    } else {
      EXPECT_GT(e.edge_waves, 1) << length;
      EXPECT_LT(e.utd, 0.15) << length;
    }
  }
}

// As in the gallery's figure "openings": behind a square in its near field UTD is the better one, behind a ring in
// pieces it fails there, too.
TEST(ModelLimits, OfRingsInPieces) {
  for (const double fresnel_number : {0.02, 0.5}) {
    const bool is_far = fresnel_number < 0.1;
    const double distance = 100 / fresnel_number;
    const OpeningErrors square = errors_behind({rectangle(20, 20)}, 20, distance),
                        ring = errors_behind({testing::regular_ring(32, 10), testing::regular_ring(32, 6)},
                                             20, distance);
    std::printf(
        "Fresnel's number %g: square, edge waves %.2g, UTD %.2g off; ring of 32 pieces, %.2g and %.2g\n",
        fresnel_number, square.edge_waves, square.utd, ring.edge_waves, ring.utd);
    EXPECT_LT(ring.edge_waves, is_far ? 0.002 : 0.1);
    EXPECT_GT(ring.utd, 1);
    EXPECT_LT(square.edge_waves, is_far ? 0.005 : 0.4);
    if (is_far) {
      EXPECT_GT(square.utd, 1);
    } else {
      EXPECT_LT(square.utd, 0.5 * square.edge_waves);
    }
  }
}

}  // namespace
}  // namespace aureole::optics
