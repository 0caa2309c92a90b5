// SPDX-License-Identifier: Apache-2.0
// Ward's model: the harness, values by the published formulas, closed forms of the energy at normal
// incidence, and which variants conserve it elsewhere.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"

namespace aureole::testing {
namespace {

std::string colors(double diffuse, double specular) {
  return number("diffuse_reflectance", diffuse) + number("specular_reflectance", specular);
}
std::string shape(const char* variant, double alpha_u, double alpha_v) {
  return std::string("<string name=\"variant\" value=\"") + variant + "\"/>" + number("alpha_u", alpha_u) +
         number("alpha_v", alpha_v);
}
BsdfCase make_case(const char* name, const std::string& parameters, double energy = 1) {
  BsdfCase c;
  c.name = std::string("ward_") + name;
  c.xml = "<bsdf type=\"ward\">" + parameters + "</bsdf>";
  c.black_below = c.may_fail = true;
  if (energy > 1) c.gains_energy = "Ward's and Duer's normalisations diverge towards grazing";
  c.largest_energy = energy;
  return c;
}
const BsdfCases kCases("ward", [](BsdfCase& c) { c.black_below = c.may_fail = true; },
                       {make_case("default", ""),
                        make_case("balanced", colors(0, 1) + shape("balanced", 0.3, 0.3)),
                        make_case("balanced_anisotropic", colors(0.2, 0.8) + shape("balanced", 0.05, 0.4)),
                        make_case("balanced_rough", colors(0, 1) + shape("balanced", 1, 1)),
                        make_case("ward", colors(0, 1) + shape("ward", 0.2, 0.2)),
                        make_case("ward_anisotropic", colors(0.3, 0.6) + shape("ward", 0.1, 0.3)),
                        make_case("duer", colors(0, 1) + shape("ward-duer", 0.2, 0.2), 1.5),
                        make_case("duer_anisotropic", colors(0.3, 0.6) + shape("ward-duer", 0.1, 0.3), 1.5),
                        make_case("textured", R"(<rgb name="specular_reflectance" value="0.1, 0.5, 0.3"/>
         <rgb name="diffuse_reflectance" value="0.5, 0.1, 0.1"/>
         <texture type="checkerboard" name="alpha_u"><float name="color0" value="0.1"/>
         <float name="color1" value="0.3"/></texture>)")});

/// The three formulas as published: of the angles (delta, phi) of the half vector, and of the vector i + o.
TEST(Ward, IsItsFormulas) {
  const double au = 0.25, av = 0.4, rho = 0.7;
  for (const double theta_i : {0.2, 0.8, 1.3})
    for (const double theta_o : {0.1, 0.9, 1.2})
      for (const double phi_o : {1.0, 2.8, 3.5}) {
        const double i[3] = {std::sin(theta_i), 0, std::cos(theta_i)};
        const double o[3] = {std::sin(theta_o) * std::cos(phi_o), std::sin(theta_o) * std::sin(phi_o),
                             std::cos(theta_o)};
        const double h[3] = {i[0] + o[0], i[1] + o[1], i[2] + o[2]};
        const double delta = std::atan2(std::hypot(h[0], h[1]), h[2]), phi = std::atan2(h[1], h[0]);
        const double gauss = std::exp(-std::pow(std::tan(delta), 2) *
                                      (std::pow(std::cos(phi) / au, 2) + std::pow(std::sin(phi) / av, 2)));
        const double base = rho * gauss / (4 * kPiDouble * au * av), cc = i[2] * o[2];
        const double hh = h[0] * h[0] + h[1] * h[1] + h[2] * h[2];
        const double f[3] = {base / std::sqrt(cc), base / cc, 4 * base * hh / std::pow(h[2], 4)};
        const char* names[3] = {"ward", "ward-duer", "balanced"};
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(brdf(*bsdf_of("ward", colors(0, rho) + shape(names[k], au, av)), direction(theta_i, 0),
                           direction(theta_o, phi_o)),
                      f[k], 1e-4 * f[k] + 1e-30)
              << names[k] << " " << theta_i << " " << theta_o << " " << phi_o;
      }
}

/// At normal incidence, with t = tan^2 of the half vector's angle distributed as exp(-t/a^2)/a^2 and the
/// light above the surface for t < 1, a sample weighs (1 - t) in balanced, sqrt((1-t)/(1+t))/(1+t)^2 in ward
/// and 1/(1+t)^2 in ward-duer.
TEST(Ward, EnergyAtNormalIncidence) {
  const auto integral = [](double a, auto&& weight) {
    constexpr int kN = 20000;
    double sum = 0;
    for (int i = 0; i < kN; ++i) {
      const double t = (i + 0.5) / kN;
      sum += std::exp(-t / (a * a)) / (a * a) * weight(t) / kN;
    }
    return sum;
  };
  for (const double a : {0.1, 0.3, 0.6}) {
    const auto energy = [&](const char* variant) {
      return albedo(*bsdf_of("ward", colors(0, 1) + shape(variant, a, a)), {0, 0, 1}, 500);
    };
    EXPECT_NEAR(energy("balanced"), 1 - a * a * (1 - std::exp(-1 / (a * a))), 2e-4) << a;
    EXPECT_NEAR(energy("ward"),
                integral(a, [](double t) { return std::sqrt((1 - t) / (1 + t)) / ((1 + t) * (1 + t)); }),
                2e-4)
        << a;
    EXPECT_NEAR(energy("ward-duer"), integral(a, [](double t) { return 1 / ((1 + t) * (1 + t)); }), 2e-4)
        << a;
  }
}

/// Only `balanced` conserves energy at all angles; the others do so as far as their documentation says.
TEST(Ward, EnergyTowardsGrazing) {
  const double roughness[][2] = {{0.05, 0.05}, {0.1, 0.1}, {0.3, 0.3}, {0.05, 0.5}, {1, 1}};
  struct {
    const char* variant;
    double last;  // degrees to which energy is conserved
  } variants[] = {{"balanced", 89.99}, {"ward", 89.5}, {"ward-duer", 80}};
  for (const auto& v : variants) {
    double conserved = 0, largest = 0;
    for (const auto& r : roughness) {
      const auto bsdf = bsdf_of("ward", colors(0, 1) + shape(v.variant, r[0], r[1]));
      for (const double d : {0.0, 45.0, 60.0, 80.0, 85.0, 88.0, 89.5, 89.99}) {
        const double energy = sampled_albedo(*bsdf, direction(d * kPiDouble / 180, 0.4), 256);
        largest = std::max(largest, energy);
        if (d <= v.last) conserved = std::max(conserved, energy);
        if (r[0] == 0.1)
          RecordProperty(std::string(v.variant) + "_at_" + std::to_string(d), std::to_string(energy));
      }
    }
    EXPECT_LT(conserved, 1 + 1e-3) << v.variant;
    RecordProperty(std::string(v.variant) + "_largest", std::to_string(largest));
    if (v.last < 89.9) {
      EXPECT_GT(largest, 3) << v.variant << ": documented to diverge";
    }
  }
}

TEST(Ward, ErrorsNameThePlace) {
  expect_error("ward", R"(<string name="variant" value="duer"/>)", "ward-duer");
  expect_error("ward", number("alpha_u", 0), "above 0");
  expect_error("ward", number("diffuse_reflectance", -0.5), "negative");
}

}  // namespace
}  // namespace aureole::testing
