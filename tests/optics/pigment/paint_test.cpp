// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "aureole/pigment/hiding.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Palette two_paints() {
  return {.nm = {450, 650},
          .pigments = {{.name = "white", .k = {0.01, 0.005}, .s = {1, 1}, .density = 1500},
                       {.name = "red", .k = {2, 0.02}, .s = {0.3, 0.4}, .density = 1000}}};
}

TEST(Paint, MixturesAddCoefficients) {
  const Palette palette = two_paints();
  const std::vector<double> parts{3, 1};
  const Paint paint = mix(palette, fractions_of_parts(parts));
  EXPECT_NEAR(paint[0].k, 0.75 * 0.01 + 0.25 * 2, 1e-15);
  EXPECT_NEAR(paint[1].s, 0.75 + 0.25 * 0.4, 1e-15);
  // Two parts of white by volume weigh as much as three of red.
  EXPECT_NEAR(fractions_of_volumes(palette, std::vector<double>{2, 3})[0], 0.5, 1e-15);
  const auto opaque = paint_reflectance(paint, kInfinity, {}, {});
  EXPECT_NEAR(k_over_s(opaque[0]), paint[0].k / paint[0].s, 1e-12);
  // A thin layer shows its substrate, a thick one does not.
  const double substrate[] = {0.7};
  EXPECT_NEAR(paint_reflectance(paint, 0, substrate, {})[1], 0.7, 1e-15);
  EXPECT_NEAR(paint_reflectance(paint, 1e4, substrate, {})[1], opaque[1], 1e-12);
}

TEST(Paint, OneConstant) {
  // K/S of a tint in a base whose scattering the colorant leaves as it is.
  const double base = 0.02, unit = unit_k_over_s(0.42, base, 0.1);
  EXPECT_NEAR(unit, 4, 1e-14);
  const Colorant colorants[] = {{0.05, unit}, {0.01, 2}};
  EXPECT_NEAR(single_constant_k_over_s(base, colorants), 0.24, 1e-15);
}

TEST(Paint, WrongInputIsNamed) {
  Palette palette = two_paints();
  check(palette);
  EXPECT_THROW(fractions_of_parts(std::vector<double>{-1, 2}), std::domain_error);
  EXPECT_THROW(fractions_of_parts(std::vector<double>{0, 0}), std::domain_error);
  EXPECT_THROW(mix(palette, std::vector<double>{0.5, 0.6}), std::domain_error);
  EXPECT_THROW(mix(palette, std::vector<double>{1}), std::domain_error);
  EXPECT_THROW(paint_reflectance(mix(palette, std::vector<double>{1, 0}), 1, {}, {}), std::domain_error);
  palette.pigments[1].density = 0;
  EXPECT_THROW(fractions_of_volumes(palette, std::vector<double>{1, 1}), std::domain_error);
  palette.pigments[1].k[0] = -0.1;
  EXPECT_EQ(clamp_negative(palette), 1);
  EXPECT_EQ(palette.pigments[1].k[0], 0);
  palette.pigments[1].s[0] = std::nan("");
  EXPECT_THROW(check(palette), std::domain_error);
  palette = two_paints();
  palette.pigments[1].name = "white";
  EXPECT_THROW(check(palette), std::domain_error);
  palette = two_paints();
  palette.nm = {650, 450};
  EXPECT_THROW(check(palette), std::domain_error);
}

TEST(Hiding, ThicknessOfContrast) {
  // Without absorption R = SX/(1 + SX) over black: a quadratic equation for SX, over a white of 1 simply C/(1
  // - C).
  EXPECT_NEAR(hiding_thickness(Coefficients{0, 2}, {}, 0.98, 0, 1), 0.98 / 0.02 / 2, 1e-10);
  const Surface surface = saunderson_surface(0.04, 0.6, Specular::included);
  const Coefficients c{0.1, 3};
  const double hidden = hiding_thickness(c, surface);
  EXPECT_NEAR(contrast_ratio(c, hidden, surface), 0.98, 1e-11);
  EXPECT_LT(contrast_ratio(c, 0.999 * hidden, surface), 0.98);
  EXPECT_TRUE(std::isinf(hiding_thickness(Coefficients{0, 0})));
  EXPECT_THROW(hiding_thickness(c, surface, 1.1), std::domain_error);
  EXPECT_THROW(contrast_ratio(c, 1, surface, 0.8, 0.1), std::domain_error);
}

TEST(Hiding, TintingStrength) {
  EXPECT_NEAR(tinting_strength(0.52, 0.42, 0.02), 1.25, 1e-15);
  EXPECT_THROW(tinting_strength(0.5, 0.02, 0.02), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment
