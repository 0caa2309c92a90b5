// SPDX-License-Identifier: Apache-2.0
// Cook-Torrance: the harness, values by its formula in double precision and angles, limits, and its energy
// with either denominator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aureole/optics/interface/fresnel_equations.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"

namespace aureole::testing {
namespace {

const std::string kMirror = number("specular", 1) + number("eta", 0) + number("k", 1);
const std::string kPiDenominator = R"(<string name="denominator" value="pi"/>)";

BsdfCase make_case(const char* name, const std::string& parameters, double energy = 1) {
  BsdfCase c;
  c.name = std::string("cook_torrance_") + name;
  c.xml = "<bsdf type=\"cook_torrance\">" + parameters + "</bsdf>";
  c.black_below = c.may_fail = true;
  if (energy > 1) c.gains_energy = "the denominator pi is too small by pi/4";
  c.largest_energy = energy;
  return c;
}
const BsdfCases kCases("cook_torrance", [](BsdfCase& c) { c.black_below = c.may_fail = true; },
                       {make_case("default", ""), make_case("mirror", kMirror + number("alpha", 0.1)),
                        make_case("mirror_rough", kMirror + number("alpha", 0.8)),
                        make_case("mirror_pi", kMirror + number("alpha", 0.2) + kPiDenominator, 1.274),
                        make_case("two_scales", kMirror + number("alpha", 0.4) + number("alpha_2", 0.1) +
                                                    number("weight_2", 0.6)),
                        make_case("diffuse_only", number("specular", 0) + number("diffuse_reflectance", 1)),
                        make_case("dark", number("specular", 0.3) + number("diffuse", 0.2) +
                                              number("specular_reflectance", 0)),
                        make_case("coloured", R"(<rgb name="specular_reflectance" value="0.9, 0.5, 0.2"/>
         <rgb name="diffuse_reflectance" value="0.1, 0.2, 0.7"/>
         <texture type="checkerboard" name="alpha"><float name="color0" value="0.2"/>
         <float name="color1" value="0.5"/></texture>)")});

struct Angles {
  double cos_i, cos_o, cos_h, cos_ih, delta;
};
Angles angles_of(double theta_i, double theta_o, double phi) {
  const double cos_io =
      std::sin(theta_i) * std::sin(theta_o) * std::cos(phi) + std::cos(theta_i) * std::cos(theta_o);
  const double cos_ih = std::sqrt((1 + cos_io) / 2);  // half the angle between the two
  const double cos_h = (std::cos(theta_i) + std::cos(theta_o)) / (2 * cos_ih);
  return {std::cos(theta_i), std::cos(theta_o), cos_h, cos_ih, std::acos(std::min(cos_h, 1.0))};
}
double beckmann(double delta, double m) {
  return std::exp(-std::pow(std::tan(delta) / m, 2)) / (kPiDouble * m * m * std::pow(std::cos(delta), 4));
}
double groove(const Angles& a) {
  return std::min({1.0, 2 * a.cos_h * a.cos_i / a.cos_ih, 2 * a.cos_h * a.cos_o / a.cos_ih});
}

TEST(CookTorrance, IsItsFormula) {
  const double s = 0.6, d = 0.3, rho = 0.4, m1 = 0.3, m2 = 0.6, w2 = 0.35;
  const std::string common = number("specular", s) + number("diffuse", d) +
                             number("diffuse_reflectance", rho) + number("alpha", m1) +
                             number("alpha_2", m2) + number("weight_2", w2);
  const auto glass = bsdf_of("cook_torrance", common + number("eta", 1.6));
  const auto metal = bsdf_of("cook_torrance", common + number("eta", 0.3) + number("k", 3.1));
  const auto printed = bsdf_of("cook_torrance", common + number("eta", 1.6) + kPiDenominator);
  // (sqrt(n) - 1)^2/(n + 1)^2 of n = 1.6 at normal incidence.
  const auto reflectance =
      bsdf_of("cook_torrance", common + number("specular_reflectance", std::pow(0.6 / 2.6, 2)));
  for (const double theta_i : {0.1, 0.8, 1.4})
    for (const double theta_o : {0.2, 0.9, 1.5})
      for (const double phi : {0.3, 2.0, 3.0}) {
        const Angles a = angles_of(theta_i, theta_o, phi);
        const double shape = ((1 - w2) * beckmann(a.delta, m1) + w2 * beckmann(a.delta, m2)) * groove(a) /
                             (4 * a.cos_i * a.cos_o);
        const double dielectric = s * optics::fresnel_reflectance(a.cos_ih, 1, 1.6) * shape;
        const double conductor = s * optics::fresnel_reflectance_conductor(a.cos_ih, 1, {0.3, 3.1}) * shape;
        const Vec3 wi = direction(theta_i, 0.5), wo = direction(theta_o, 0.5 + phi);
        const double diffuse = d * rho / kPiDouble;
        EXPECT_NEAR(brdf(*glass, wi, wo), diffuse + dielectric, 2e-4 * (diffuse + dielectric));
        EXPECT_NEAR(brdf(*reflectance, wi, wo), diffuse + dielectric, 3e-4 * (diffuse + dielectric));
        EXPECT_NEAR(brdf(*metal, wi, wo), diffuse + conductor, 2e-4 * (diffuse + conductor));
        const double more = diffuse + dielectric * 4 / kPiDouble;
        EXPECT_NEAR(brdf(*printed, wi, wo), more, 2e-4 * more);
      }
}

/// At normal incidence G = min(1, 2 cos 2delta): with t = tan^2(delta), distributed as exp(-t/m^2)/m^2, that
/// is min(1, 2 (1 - t)/(1 + t)), and facets with t > 1 mirror the light downwards.
TEST(CookTorrance, EnergyAtNormalIncidence) {
  for (const double m : {0.1, 0.3, 0.6, 1.0}) {
    constexpr int kN = 20000;
    double expected = 0;
    for (int i = 0; i < kN; ++i) {
      const double t = (i + 0.5) / kN;
      expected += std::exp(-t / (m * m)) / (m * m) * std::min(1.0, 2 * (1 - t) / (1 + t)) / kN;
    }
    const auto bsdf = bsdf_of("cook_torrance", kMirror + number("alpha", m));
    EXPECT_NEAR(albedo(*bsdf, {0, 0, 1}, 500), expected, 3e-4) << m;
  }
}

TEST(CookTorrance, SmoothLimitIsFresnel) {
  const auto bsdf =
      bsdf_of("cook_torrance", number("specular", 1) + number("eta", 1.5) + number("alpha", 0.003));
  for (const double theta : {0.0, 0.5, 1.0, 1.3}) {
    const double f = optics::fresnel_reflectance(std::cos(theta), 1, 1.5);
    EXPECT_NEAR(sampled_albedo(*bsdf, direction(theta, 0.1)), f, 2e-3 * f) << theta;
  }
}

TEST(CookTorrance, EnergyOfBothDenominators) {
  double four = 0, pi = 0;
  for (const double alpha : {0.02, 0.1, 0.2, 0.4, 0.8, 1.5})
    for (const double degrees : {0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 89.9}) {
      const Vec3 wi = direction(degrees * kPiDouble / 180, 0.2);
      four = std::max(four,
                      sampled_albedo(*bsdf_of("cook_torrance", kMirror + number("alpha", alpha)), wi, 256));
      pi = std::max(
          pi, sampled_albedo(*bsdf_of("cook_torrance", kMirror + number("alpha", alpha) + kPiDenominator), wi,
                             256));
    }
  RecordProperty("largest_energy_4", std::to_string(four));
  RecordProperty("largest_energy_pi", std::to_string(pi));
  EXPECT_LT(four, 1 + 1e-3);
  EXPECT_NEAR(pi, 4 / kPiDouble * four, 1e-3);
  EXPECT_GT(pi, 1.2) << "documented to gain energy";
}

TEST(CookTorrance, ErrorsNameThePlace) {
  expect_error("cook_torrance", number("specular", 0.7) + number("diffuse", 0.5), "together at most 1");
  expect_error("cook_torrance", number("specular_reflectance", 0.5) + number("k", 1), "not both");
  expect_error("cook_torrance", number("alpha", 0), "above 0");
  expect_error("cook_torrance", R"(<string name="denominator" value="2"/>)", "pi");
}

}  // namespace
}  // namespace aureole::testing
