// SPDX-License-Identifier: Apache-2.0
// Rainbows by Mie's series against geometrical optics and Airy's theory, which share nothing with it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/optics/particle/radius_distribution.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi, kDegree = kPi / 180;

/// Deviation of the ray that is turned least after one inner reflection (Descartes), rad.
double descartes(double m) {
  const double incidence = std::acos(std::sqrt((m * m - 1) / 3));
  return kPi + 2 * incidence - 4 * std::asin(std::sin(incidence) / m);
}
/// By how much the first maximum lies beyond it in Airy's theory: the argument of Airy's function is there
/// -1.01879, in units of h^(1/3) x^(-2/3) (van de Hulst 1957, section 13.23), rad.
double airy_shift(double m, double x) {
  const double h = 9.0 / 4 * std::sqrt((4 - m * m) / std::pow(m * m - 1, 3));
  return 1.01879 * std::cbrt(h) / std::pow(x, 2.0 / 3);
}
/// Angle of the strongest light in polarisation 1 (across the plane) between two scattering angles, of
/// droplets with a spread of 3 %; a parabola through the largest of `count` values.
double brightest(double radius, double lambda_nm, double m, double low, double high, int count,
                 std::size_t most) {
  std::vector<double> mu, sum(count, 0);
  for (int i = 0; i < count; ++i) mu.push_back(std::cos(low + (high - low) * i / (count - 1)));
  const double k = 2 * kPi / (lambda_nm * 1e-9);
  std::vector<MieAmplitudes> at(mu.size());
  for (const RadiusNode& n : RadiusDistribution::log_normal(radius, 0.03).nodes(1.6 * k, 0, most)) {
    Mie(k * n.radius, m).amplitudes(mu, at);
    for (int i = 0; i < count; ++i) sum[i] += n.weight * std::norm(at[i].s1);
  }
  int best = 1;
  for (int i = 1; i + 1 < count; ++i)
    if (sum[i] > sum[best]) best = i;
  const double bend = sum[best - 1] - 2 * sum[best] + sum[best + 1];
  return low + (high - low) / (count - 1) * (best + 0.5 * (sum[best - 1] - sum[best + 1]) / bend);
}

TEST(Rainbow, GeometricAngle) {
  EXPECT_NEAR(180 - descartes(1.3312) / kDegree, 42.3, 0.05);
  EXPECT_NEAR(180 - descartes(1.3390) / kDegree, 41.2, 0.05);
}

TEST(Rainbow, AirysShift) {
  const struct {
    double radius, tolerance;
    std::size_t most;
  } drops[] = {{500e-6, 0.15, 700}, {100e-6, 0.15, 700}};
  for (const auto& drop : drops)
    for (const double m : {1.3312, 1.3390}) {
      if (drop.radius > 200e-6 && m > 1.335) continue;  // one of the large ones is enough
      const double shift = airy_shift(m, 2 * kPi * drop.radius / 550e-9), bow = descartes(m);
      const double mie = brightest(drop.radius, 550, m, bow - shift, bow + 3 * shift, 40, drop.most) - bow;
      std::printf("%g um, m %g: %.3f degrees by Airy, %.3f by Mie\n", drop.radius * 1e6, m, shift / kDegree,
                  mie / kDegree);
      EXPECT_NEAR(mie / shift, 1, drop.tolerance);
    }
}

TEST(Rainbow, Fogbow) {
  // Droplets of 10 um: the bow has moved inwards by 3.97 degrees, and is white because it is degrees wide.
  const double m = 1.3338, bow = descartes(m);
  const double mie = brightest(10e-6, 550, m, bow - 2 * kDegree, bow + 9 * kDegree, 60, 2000) - bow;
  EXPECT_NEAR(mie / kDegree, 3.97, 0.15);
  EXPECT_NEAR(mie / airy_shift(m, 2 * kPi * 10e-6 / 550e-9), 1, 0.15);
}

}  // namespace
}  // namespace aureole::optics
