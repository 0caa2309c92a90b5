// SPDX-License-Identifier: Apache-2.0
// The BSDF `tabulated` against the functions that its tables were made from (tests/bsdf/data/measured/make_tables.py).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/bsdf/measured/scattered_table.h"
#include "aureole/core/error.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/paths.h"

namespace aureole::testing {
namespace {

std::string tabulated_path(const std::string& name) {
  return (test::source_dir() / "tests/bsdf/data/measured" / name).string();
}
std::shared_ptr<Bsdf> tabulated(const std::string& path, const std::string& more = "") {
  return build<Bsdf>("<bsdf type=\"tabulated\"><string name=\"filename\" value=\"" + path + "\"/>" + more +
                     "</bsdf>");
}
std::string written_table(const std::string& text) {
  const std::string path = ::testing::TempDir() + "table.csv";
  std::ofstream(path) << text;
  return path;
}

TEST(Tabulated, PaperScattersEvenly) {
  const auto paper =
      tabulated(tabulated_path("paper_table.csv"), R"(<string name="quantity" value="intensity"/>)");
  const Setting s;
  for (const double theta : {0.0, 0.5, 1.0, 1.3})
    for (const double phi : {0.1, 2.0, 5.0}) {
      EXPECT_NEAR(brdf(*paper, direction(0.4, 1), direction(theta, phi), s), 0.5 / kPiDouble, 2e-3);
      EXPECT_NEAR(brdf(*paper, direction(0.4, 1), direction(kPiDouble - theta, phi), s), 0.3 / kPiDouble,
                  2e-3);
      EXPECT_NEAR(brdf(*paper, direction(kPiDouble - theta, phi), direction(0.4, 1), s), 0.3 / kPiDouble,
                  2e-3);
    }
  EXPECT_EQ(brdf(*paper, direction(2, 1), direction(3, 1), s), 0);
}

// GGX of alpha 0.4 over a diffuse ground, at 300 random directions: linear interpolation between directions some 5 degrees
// apart.
TEST(Tabulated, ScatteredDirectionsAreInterpolated) {
  const auto table = tabulated(tabulated_path("glossy_table.csv"));
  const auto g1 = [](double cosine) {
    return 2 / (1 + std::sqrt(1 + 0.16 * (1 - cosine * cosine) / (cosine * cosine)));
  };
  const Setting s;  // the first wavelength is 440 nm
  double errors = 0, sum = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 wi = direction(0.02 + 0.0025 * i, 1), wo = direction(0.1 + std::fmod(0.37 * i, 1.0), 0.61 * i);
    const Vec3 h = normalize(wi + wo);
    const double d = 0.16 / (kPiDouble * std::pow(double(h.z * h.z) * (0.16 - 1) + 1, 2));
    const double fresnel = 0.5 + 0.5 * std::pow(1 - double(dot(wi, h)), 5);
    const double specular =
        0.6 * fresnel * d * g1(double(wi.z)) * g1(double(wo.z)) / (4 * double(wi.z) * double(wo.z));
    const double at_400 = 0.05 * 0.8 / kPiDouble, at_550 = 0.12 * 0.8 / kPiDouble;
    const double expected = specular + at_400 + (at_550 - at_400) * 40 / 150;
    errors += std::abs(brdf(*table, wi, wo, s) - expected), sum += expected;
  }
  EXPECT_LT(errors / sum, 0.04);
}

TEST(Tabulated, AzimuthsOfAnisotropicTables) {
  std::string text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int theta_i = 0; theta_i <= 60; theta_i += 30)
    for (int phi_i = 0; phi_i < 360; phi_i += 45)
      for (int theta_o = 0; theta_o <= 80; theta_o += 20)
        for (int phi_o = 0; phi_o < 360; phi_o += 30)
          text += std::to_string(theta_i) + "," + std::to_string(phi_i) + "," + std::to_string(theta_o) +
                  "," + std::to_string(phi_o) + "," + std::to_string(0.1 + 0.05 * std::cos(phi_i * kDegree)) +
                  ",0.1,0.1\n";
  const ScatteredMeasurements m = read_scattered_measurements(written_table(text), false);
  const ScatteredTable table(m, false, "table.csv", SpectralGrid::over(360, 830));
  EXPECT_FALSE(table.is_isotropic());
  EXPECT_TRUE(ScatteredTable(m, true, "table.csv", SpectralGrid::over(360, 830)).empty());
  for (const double phi : {0.0, 45.0, 180.0, 225.0, 315.0, 350.0}) {
    const double low = 45 * std::floor(phi / 45), t = (phi - low) / 45;
    const double expected = (1 - t) * std::cos(low * kDegree) + t * std::cos((low + 45) * kDegree);
    const std::array<float, 3> c = table.colour(direction(0.6, phi * kDegree), direction(0.5, 1));
    EXPECT_NEAR(c[0], 0.1 + 0.05 * expected, 1e-4) << phi;
    EXPECT_NEAR(c[1], 0.1, 1e-5);
  }
}

std::string table_error(const std::string& text) {
  try {
    tabulated(written_table(text));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Tabulated, BadTablesAreLocatedErrors) {
  const std::string head = "theta_i,theta_o,phi_o,f\n";
  EXPECT_NE(table_error("").find("a heading and rows"), std::string::npos);
  EXPECT_NE(table_error("theta,theta_o,f\n1,2,3\n").find("unknown column \"theta\""), std::string::npos);
  EXPECT_NE(table_error("theta_o,f\n1,2\n").find("no column theta_i"), std::string::npos);
  EXPECT_NE(table_error(head + "0,1,2\n").find("table.csv:2:1: there are 3 cells under 4 headings"),
            std::string::npos);
  EXPECT_NE(table_error(head + "0,1,2,nan\n").find("table.csv:2"), std::string::npos);
  EXPECT_NE(table_error(head + "95,1,2,1\n").find("theta_i is 95"), std::string::npos);
  EXPECT_NE(table_error(head + "0,10,0,1\n0,10,180,1\n").find("three or more"), std::string::npos);
  EXPECT_NE(table_error(head + "0,10,0,1\n0,10,180,1\n0,40,180,1\n").find("lie in one plane"),
            std::string::npos);
  EXPECT_NE(
      table_error("theta_i,phi_i,theta_o,phi_o,f\n0,0,10,0,1\n30,90,10,0,1\n").find("need the same angles"),
      std::string::npos);
  EXPECT_NE(table_error("theta_i,theta_o,550nm,550\n0,1,2,3\n").find("two columns of 550 nm"),
            std::string::npos);
}

const BsdfCases kTabulated("tabulated",
                           [](BsdfCase& c) {
                             c.may_fail = true;
                             c.black_below = c.name == "tabulated_example_1";
                             c.mode = TransportMode::radiance;
                             c.not_reciprocal = "the values are interpolated between measurements";
                             c.bin_tolerance = 1e-5;
                           },
                           {});

}  // namespace
}  // namespace aureole::testing
