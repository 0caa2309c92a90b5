// SPDX-License-Identifier: Apache-2.0
// The modified Phong model: the harness, values by its formula in angles, and closed forms of its energy.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"

namespace aureole::testing {
namespace {

BsdfCase make_case(const char* name, const std::string& parameters) {
  BsdfCase c;
  c.name = std::string("phong_") + name;
  c.xml = "<bsdf type=\"phong\">" + parameters + "</bsdf>";
  c.black_below = c.may_fail = true;
  return c;
}
std::string colors(double diffuse, double specular) {
  return number("diffuse_reflectance", diffuse) + number("specular_reflectance", specular);
}
const BsdfCases kCases("phong", [](BsdfCase& c) { c.black_below = c.may_fail = true; },
                       {make_case("default", ""),
                        make_case("white", colors(0.5, 0.5) + number("exponent", 10)),
                        make_case("specular", colors(0, 1) + number("exponent", 3)),
                        make_case("flat", colors(0, 1) + number("exponent", 0)),
                        make_case("sharp", colors(0.1, 0.9) + number("exponent", 5000)),
                        make_case("textured", R"(<rgb name="specular_reflectance" value="0.1, 0.5, 0.3"/>
                            <rgb name="diffuse_reflectance" value="0.5, 0.1, 0.1"/>
                            <texture type="checkerboard" name="exponent"><float name="color0" value="1"/>
                            <float name="color1" value="0.5"/></texture>)")});

TEST(Phong, IsItsFormula) {
  const auto bsdf = bsdf_of("phong", colors(0.3, 0.6) + number("exponent", 12.5));
  const double theta_i = 0.6;
  // wo at an angle gamma from the mirror direction, in the plane of incidence.
  for (const double gamma : {0.0, 0.2, 0.5, 0.9}) {
    const double f = 0.3 / kPiDouble + 0.6 * (12.5 + 2) / (2 * kPiDouble) * std::pow(std::cos(gamma), 12.5);
    EXPECT_NEAR(brdf(*bsdf, direction(theta_i, 0.2), direction(theta_i + gamma, 0.2 + kPiDouble)), f,
                2e-5 * f);
  }
}

/// exponent 0: the half of the hemisphere that the mirror direction sees; 1: a product of two cosines.
TEST(Phong, EnergyHasClosedForms) {
  const auto flat = bsdf_of("phong", colors(0, 0.8) + number("exponent", 0));
  const auto cosine = bsdf_of("phong", colors(0, 0.8) + number("exponent", 1));
  for (const double theta : {0.0, 0.4, 1.0, 1.5}) {
    const Vec3 wi = direction(theta, 0.3);
    EXPECT_NEAR(albedo(*flat, wi), 0.8 * (1 + std::cos(theta)) / 2, 2e-3) << theta;
    EXPECT_NEAR(albedo(*cosine, wi),
                0.8 / kPiDouble * (std::sin(theta) + (kPiDouble - theta) * std::cos(theta)), 1e-4)
        << theta;
  }
  for (const double exponent : {0.0, 1.0, 5.0, 30.0, 300.0}) {
    const auto bsdf = bsdf_of("phong", colors(0, 1) + number("exponent", exponent));
    EXPECT_NEAR(albedo(*bsdf, {0, 0, 1}), 1, 5e-4) << exponent;
    double previous = 1 + 5e-4;
    for (const double theta : {0.3, 0.8, 1.2, 1.5}) {
      const double energy = albedo(*bsdf, direction(theta, 0));
      EXPECT_LE(energy, previous) << exponent << " " << theta;
      previous = energy + 1e-4;
    }
  }
}

/// f is not divided by a cosine: a sharp lobe reflects the cosine of its angle.
TEST(Phong, SharpLobesReflectTheCosine) {
  const auto bsdf = bsdf_of("phong", colors(0, 1) + number("exponent", 20000));
  for (const double theta : {0.0, 0.5, 1.0, 1.3})
    EXPECT_NEAR(sampled_albedo(*bsdf, direction(theta, 0.3)), std::cos(theta), 1e-3);
}

TEST(Phong, ExponentZeroIsLambertianAtNormalIncidence) {
  const auto bsdf = bsdf_of("phong", colors(0.2, 0.5) + number("exponent", 0));
  for (const double theta : {0.1, 0.8, 1.4})
    EXPECT_NEAR(brdf(*bsdf, {0, 0, 1}, direction(theta, 1)), 0.7 / kPiDouble, 1e-6);
}

TEST(Phong, BrightColoursAreScaledWithANote) {
  Diagnostics diagnostics;
  const auto context = make_context(360, 830, &diagnostics);
  const auto bsdf = build<Bsdf>("<bsdf type=\"phong\">" + colors(0.8, 0.8) + "</bsdf>", context);
  ASSERT_EQ(diagnostics.notes().size(), 1u);
  EXPECT_NE(diagnostics.notes()[0].find("add up to 1.6"), std::string::npos) << diagnostics.notes()[0];
  EXPECT_NEAR(albedo(*bsdf, {0, 0, 1}), 1, 1e-3);
  // Only where they do: this blue has a reflectance of one at the red end, but not in between.
  const std::string blue = R"(<rgb name="diffuse_reflectance" value="0.2, 0.1, 0.6"/>)";
  const auto with = bsdf_of("phong", blue + number("specular_reflectance", 0.3) + number("exponent", 0));
  const auto without = bsdf_of("phong", blue + number("specular_reflectance", 0));
  const Setting s;
  const Vec3 n{0, 0, 1};
  const Spectrum added = with->eval(n, n, s.context()) - without->eval(n, n, s.context());
  for (int j = 0; j < kWavelengths; ++j) EXPECT_NEAR(added[j] * kPi, 0.3, 1e-5) << j;
}

TEST(Phong, ErrorsNameThePlace) {
  expect_error("phong", number("exponent", -1), "must not be negative");
  expect_error("phong", number("specular_reflectance", 1.5), "[0, 1]");
  expect_error("phong", R"(<string name="exponent" value="sharp"/>)", "exponent");
}

}  // namespace
}  // namespace aureole::testing
