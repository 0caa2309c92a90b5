// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace aureole {
namespace {

struct Chromaticity {
  const char* name;
  double x, y, tolerance;
};

// Chromaticities as published: CIE 15:2004, and CIE 015:2018 for LEDs. Lamps are published to four decimals,
// from sums at 5 nm.
constexpr Chromaticity kPublished[] = {
    {"A", 0.44758, 0.40745, 5e-5},    {"C", 0.31006, 0.31616, 1e-4},     {"D50", 0.34567, 0.35850, 5e-5},
    {"D55", 0.33243, 0.34744, 5e-5},  {"D65", 0.31272, 0.32903, 5e-5},   {"D75", 0.29903, 0.31488, 5e-5},
    {"FL1", 0.3131, 0.3371, 3e-4},    {"FL2", 0.3721, 0.3751, 3e-4},     {"FL3", 0.4091, 0.3941, 3e-4},
    {"FL4", 0.4402, 0.4031, 3e-4},    {"FL5", 0.3138, 0.3452, 3e-4},     {"FL6", 0.3779, 0.3882, 3e-4},
    {"FL7", 0.3129, 0.3292, 3e-4},    {"FL8", 0.3458, 0.3586, 3e-4},     {"FL9", 0.3741, 0.3727, 3e-4},
    {"FL10", 0.3458, 0.3588, 5e-4},   {"FL11", 0.3805, 0.3769, 5e-4},    {"FL12", 0.4370, 0.4042, 5e-4},
    {"HP1", 0.5330, 0.4150, 5e-4},    {"HP2", 0.4778, 0.4158, 5e-4},     {"HP3", 0.4302, 0.4075, 5e-4},
    {"HP4", 0.3812, 0.3797, 5e-4},    {"HP5", 0.3776, 0.3713, 5e-4},     {"LED-B1", 0.4560, 0.4078, 3e-4},
    {"LED-B2", 0.4357, 0.4012, 3e-4}, {"LED-B3", 0.3756, 0.3723, 3e-4},  {"LED-B4", 0.3422, 0.3502, 3e-4},
    {"LED-B5", 0.3118, 0.3236, 3e-4}, {"LED-BH1", 0.4474, 0.4066, 3e-4}, {"LED-RGB1", 0.4557, 0.4211, 3e-4},
    {"LED-V1", 0.4548, 0.4044, 4e-4}, {"LED-V2", 0.3781, 0.3775, 4e-4},
};

TEST(Observer, IsTheStandardTable) {
  const Observer& observer = cie_1931_observer();
  ASSERT_EQ(observer.y.size(), 471u);
  EXPECT_EQ(observer.start_nm, 360.0);
  EXPECT_EQ(observer.step_nm, 1.0);
  EXPECT_EQ(observer.y[555 - 360], 1.0);
  EXPECT_NEAR(observer.y[510 - 360], 0.503, 1e-12);
  EXPECT_NEAR(observer.x[600 - 360], 1.0622, 1e-12);
  EXPECT_NEAR(observer.z[450 - 360], 1.77211, 1e-12);
}

TEST(Observer, IntegralsAgree) {
  // All three curves have the same area, to the precision of the standard, so that equal energy is white.
  const Observer& observer = cie_1931_observer();
  EXPECT_NEAR(cie_y_integral(), 106.856895, 3e-5);
  EXPECT_NEAR(std::accumulate(observer.x.begin(), observer.x.end(), 0.0), 106.8657, 1e-3);
  EXPECT_NEAR(std::accumulate(observer.z.begin(), observer.z.end(), 0.0), 106.8922, 1e-3);
}

TEST(Illuminants, HavePublishedChromaticities) {
  for (const Chromaticity& c : kPublished) {
    const auto illuminant = find_illuminant(c.name);
    ASSERT_TRUE(illuminant.has_value()) << c.name;
    const auto xyz = cie_tristimulus(*illuminant);
    const double sum = xyz[0] + xyz[1] + xyz[2];
    EXPECT_NEAR(xyz[0] / sum, c.x, c.tolerance) << c.name;
    EXPECT_NEAR(xyz[1] / sum, c.y, c.tolerance) << c.name;
  }
}

TEST(Illuminants, AreFoundByEveryName) {
  for (const std::string& name : illuminant_names()) {
    const auto illuminant = find_illuminant(name);
    ASSERT_TRUE(illuminant.has_value()) << name;
    ASSERT_EQ(illuminant->values.size(), illuminant->wavelengths_nm.size()) << name;
    for (double v : illuminant->values) EXPECT_GE(v, 0.0) << name;
    EXPECT_GE(illuminant->wavelengths_nm.back(), 780.0) << name;
  }
  EXPECT_EQ(find_illuminant("f11")->values.data(), find_illuminant("FL11")->values.data());
  EXPECT_EQ(find_illuminant("F3.12")->values.data(), find_illuminant("fl3.12")->values.data());
  EXPECT_EQ(find_illuminant("led-rgb1")->values.data(), find_illuminant("LED-RGB1")->values.data());
  EXPECT_FALSE(find_illuminant("D66").has_value());
  EXPECT_FALSE(find_illuminant("").has_value());
  EXPECT_FALSE(find_illuminant("F").has_value());
  EXPECT_FALSE(find_illuminant("F13").has_value());
}

TEST(Illuminants, AreInterpolatedLinearlyAndZeroOutside) {
  const TabulatedSpectrum d65 = *find_illuminant("D65");
  EXPECT_EQ(d65.at(560), 100.0);
  EXPECT_EQ(d65.at(300), 0.0341);
  EXPECT_EQ(d65.at(830), 60.3125);
  EXPECT_EQ(d65.at(360), 46.6383);
  EXPECT_DOUBLE_EQ(d65.at(562), 100.0 + 0.4 * (98.1671 - 100.0));
  EXPECT_EQ(d65.at(299.99), 0.0);
  EXPECT_EQ(d65.at(830.01), 0.0);
  EXPECT_EQ(d65.at(NAN), 0.0);
  EXPECT_EQ(TabulatedSpectrum{}.at(500), 0.0);
  EXPECT_EQ(find_illuminant("A")->at(560), 100.0);
}

TEST(Illuminants, AFollowsPlanckAcrossTheExtension) {
  const TabulatedSpectrum a = *find_illuminant("A");
  const auto planck = [](double nm) { return std::pow(nm, -5) / std::expm1(1.435e7 / (2848 * nm)); };
  for (double nm = 300; nm <= 830; nm += 5)
    EXPECT_NEAR(a.at(nm) / (100 * planck(nm) / planck(560)), 1, 1e-5) << nm;
}

TEST(Illuminants, NormalizedD65HasUnitLuminance) {
  const double y =
      cie_tristimulus(*find_illuminant("D65"))[1] * d65_whitepoint_normalization() / cie_y_integral();
  EXPECT_NEAR(y, 1.0, 1e-14);
  // Mitsuba 3 uses 98.99741751876255 with 106.7502594 nm for the integral of y-bar: the product must agree.
  EXPECT_NEAR(cie_y_integral() / d65_whitepoint_normalization() / (98.99741751876255 * 106.7502593994140625),
              1, 1e-4);
}

}  // namespace
}  // namespace aureole
