// SPDX-License-Identifier: Apache-2.0
// The numbers of docs/diffraction.md: where one model stops and the next one is needed.
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace aureole::optics
