// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_spaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "aureole/instrument/paint/paint_colour.h"

namespace aureole::pigment {
namespace {

// Illuminant D65 of the CIE 1931 observer: x 0.31272, y 0.32903, u' 0.1978, v' 0.4683 (CIE 15:2018, table T.3).
TEST(ColourSpaces, ChromaticityOfD65IsCies) {
  const UcsChromaticity c = ucs_chromaticity({0.31272 / 0.32903, 1, (1 - 0.31272 - 0.32903) / 0.32903});
  EXPECT_NEAR(c.u, 0.1978, 5e-5);
  EXPECT_NEAR(c.v, 0.4683, 5e-5);
  EXPECT_EQ(ucs_chromaticity({0, 0, 0}).u, 0);
}

// Computed by hand: Y = 0.2 of white 1 has L* = 116 0.2^(1/3) - 16 = 51.837.
TEST(ColourSpaces, LuvOfADarkRedIsComputedByHand) {
  const Xyz white{0.95047, 1, 1.08883}, red{0.3, 0.2, 0.05};
  const Luv luv = luv_of_xyz(red, white);
  const double l = 116 * std::cbrt(0.2) - 16, u = 4 * 0.3 / (0.3 + 3 + 0.15), v = 9 * 0.2 / (0.3 + 3 + 0.15);
  const double un = 4 * 0.95047 / (0.95047 + 15 + 3 * 1.08883), vn = 9 / (0.95047 + 15 + 3 * 1.08883);
  EXPECT_NEAR(luv.l, l, 1e-9);
  EXPECT_NEAR(luv.u, 13 * l * (u - un), 1e-9);
  EXPECT_NEAR(luv.v, 13 * l * (v - vn), 1e-9);
  EXPECT_EQ(luv_of_xyz({0, 0, 0}, white).l, 0);
  EXPECT_NEAR(luv_of_xyz(white, white).u, 0, 1e-12);
}

TEST(ColourSpaces, MixturesOfWhiteAndMonochromaticLightHaveItsWavelength) {
  // The locus of the observer itself at 1 nm, and mixtures by the law of the lever.
  std::vector<double> nm;
  for (int l = 360; l <= 780; ++l) nm.push_back(l);
  std::vector<Chromaticity> locus;
  const Observation observer = observe("E", nm);
  for (const Xyz& w : observer.weights()) locus.push_back(chromaticity(w));
  const std::span<const double> range(nm.begin() + 40, nm.begin() + 341);
  const std::span<const Chromaticity> points(locus.begin() + 40, locus.begin() + 341);
  const Chromaticity white{0.3127, 0.3290};
  for (const int l : {450, 480, 520, 560, 600}) {
    const Chromaticity& pure = locus[std::size_t(l - 360)];
    const Chromaticity mixed{0.4 * white.x + 0.6 * pure.x, 0.4 * white.y + 0.6 * pure.y};
    const DominantWavelength d = dominant_wavelength(mixed, white, range, points);
    EXPECT_NEAR(d.nm, l, 0.2);
    EXPECT_NEAR(d.purity, 0.6, 2e-3);
    EXPECT_FALSE(d.is_complementary);
  }
  // A purple: opposite of green, on the line between the ends of the spectrum.
  const Chromaticity half{0.5 * (points.front().x + points.back().x),
                          0.5 * (points.front().y + points.back().y)};
  const Chromaticity purple{0.5 * (white.x + half.x), 0.5 * (white.y + half.y)};
  const DominantWavelength d = dominant_wavelength(purple, white, range, points);
  EXPECT_TRUE(d.is_complementary);
  EXPECT_GT(d.nm, 500);
  EXPECT_LT(d.nm, 570);
  EXPECT_NEAR(d.purity, 0.5, 1e-3);
  EXPECT_EQ(dominant_wavelength(white, white, range, points).nm, 0);
}

// Wavelengths of the primary 700 nm and of CIE's table: the chromaticity of 520 nm is (0.0743, 0.8338).
TEST(ColourSpaces, SpectrumLocusIsTheObservers) {
  std::vector<double> nm;
  for (int l = 360; l <= 780; ++l) nm.push_back(l);
  const auto weights = observe("E", nm).weights();
  const Chromaticity c = chromaticity(weights[520 - 360]);
  EXPECT_NEAR(c.x, 0.0743, 2e-4);
  EXPECT_NEAR(c.y, 0.8338, 2e-4);
}

}  // namespace
}  // namespace aureole::pigment
