// SPDX-License-Identifier: Apache-2.0
// Edge waves beside a wave solver: two slits and two cubes at 10 GHz after bempp-cl. references/make_bem_references.py has made the numbers
// and says what they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <string_view>
#include <vector>

#include "aureole/optics/diffraction/edge_wave.h"

namespace aureole::optics {
namespace {

constexpr double kWavelength = 299792458.0 / 10e9, kWaveNumber = 2 * M_PI / kWavelength;

struct Row {
  std::string_view scene;
  double degrees;
  double intensity;  ///< m^2/sr
};
const Row kRows[] = {
#include "optics/diffraction/references/bem_references.inc"
};

/// Two rectangles beside one another.
PolygonRegion pair(double width, double height, double apart) {
  std::vector<Ring> rings;
  for (const double x : {-0.5 * apart, 0.5 * apart})
    rings.push_back({{x - width / 2, -height / 2},
                     {x + width / 2, -height / 2},
                     {x + width / 2, height / 2},
                     {x - width / 2, height / 2}});
  return PolygonRegion::even_odd(rings);
}

/// Of edge waves; by Babinet's principle an obstacle's is that of an opening of its outline.
double intensity(const PolygonRegion& region, double degrees) {
  const double q = kWaveNumber * std::sin(degrees * M_PI / 180);
  const std::complex<double> field = degrees > 0 ? edge_field(region_edges(region), {q, 0}) : region.area();
  return std::norm(field) / (kWavelength * kWavelength);
}

double db(double ratio) { return 10 * std::log10(ratio); }

// The scalar integrals guess that the field in an opening is that of the light. Slits of two wavelengths are about the narrowest
// for which that serves. Half as many nodes change the solver's numbers by .08 dB.
TEST(Bem, TwoSlits) {
  const PolygonRegion slits = pair(0.06, 0.24, 0.12);
  const double ahead = intensity(slits, 0);
  double worst = 0;
  int compared = 0;
  for (const Row& r : kRows) {
    if (r.scene != "slits") continue;
    const double model = intensity(slits, r.degrees), off = db(model / r.intensity);
    if (int(r.degrees) % 4 == 0)
      std::printf("two slits, %2g degrees: %.4g m^2/sr by the solver, edge waves %+.2f dB\n", r.degrees,
                  r.intensity, off);
    if (r.degrees > 20) {
      // In the dark places between lobes the model has zeros and a real screen has not.
      EXPECT_NEAR(model, r.intensity, 0.01 * ahead) << r.degrees;
    } else if (model > 0.02 * ahead) {
      EXPECT_NEAR(off, 0, 0.4) << r.degrees;
      worst = std::max(worst, std::abs(off)), ++compared;
    }
  }
  EXPECT_GT(compared, 15);
  std::printf("two slits: edge waves within %.2f dB of the solver up to 20 degrees, in lobes\n", worst);
}

// Along the sides of a soft cube, which the light grazes, the field vanishes: the shadow is wider than the cube. In the parabolic
// approximation u = erf(x sqrt(k/(2 i z))) beside a wall, so that after the length L the light lacks
// the width delta = integral of 1 - u = sqrt(2 i L/(pi k)) at each side.
TEST(Bem, TwoCubes) {
  const PolygonRegion cubes = pair(0.09, 0.09, 0.135);
  double solver = 0;
  for (const Row& r : kRows) {
    if (r.scene != "cubes") continue;
    if (r.degrees == 0) solver = r.intensity;
    if (int(r.degrees) % 4 == 0)
      std::printf("two cubes, %2g degrees: %.4g m^2/sr by the solver, edge waves %+.2f dB\n", r.degrees,
                  r.intensity, db(intensity(cubes, r.degrees) / r.intensity));
    // Light missing at the sides has the cube's size, so that the lobes keep their width and their places.
    if (r.degrees > 20) {
      EXPECT_NEAR(intensity(cubes, r.degrees), r.intensity, 0.05 * solver) << r.degrees;
    }
  }
  ASSERT_GT(solver, 0);
  const std::complex<double> delta = std::sqrt(std::complex<double>(0, 2) * 0.09 / (M_PI * kWaveNumber)),
                             side = 0.09 + 2.0 * delta;
  const double widened = std::norm(2.0 * side * side) / (kWavelength * kWavelength);
  std::printf("two cubes, straight on: edge waves %+.2f dB, with the light that the walls take %+.2f dB\n",
              db(intensity(cubes, 0) / solver), db(widened / solver));
  EXPECT_LT(db(intensity(cubes, 0) / solver), -3.5);
  EXPECT_NEAR(db(widened / solver), 0, 0.3);
}

}  // namespace
}  // namespace aureole::optics
