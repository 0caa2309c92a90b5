// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/refractive_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

namespace aureole {
namespace {

constexpr double kD = 589.3, kHeliumD = 587.5618, kF = 486.1327, kC = 656.2725;

double n_of(const char* name, double nm, bool dispersion = true) {
  const auto index = find_refractive_index(name, dispersion);
  return index ? index->at(nm).real() : NAN;
}

/// Reflectance at normal incidence from vacuum.
double reflectance(const char* name, double nm) {
  const std::complex<double> n = find_refractive_index(name)->at(nm);
  return std::norm((n - 1.0) / (n + 1.0));
}

TEST(Dielectrics, HavePublishedIndices) {
  // Data sheets of Schott.
  EXPECT_NEAR(n_of("bk7", kHeliumD), 1.51680, 1e-5);
  EXPECT_NEAR(n_of("bk7", kF), 1.52238, 1e-5);
  EXPECT_NEAR(n_of("bk7", kC), 1.51432, 1e-5);
  EXPECT_NEAR((n_of("bk7", kHeliumD) - 1) / (n_of("bk7", kF) - n_of("bk7", kC)), 64.17, 0.01);
  EXPECT_NEAR((n_of("f2", kHeliumD) - 1) / (n_of("f2", kF) - n_of("f2", kC)), 36.37, 0.01);
  EXPECT_NEAR((n_of("sf11", kHeliumD) - 1) / (n_of("sf11", kF) - n_of("sf11", kC)), 25.68, 0.01);
  EXPECT_NEAR(n_of("f2", kHeliumD), 1.62004, 1e-5);
  EXPECT_NEAR(n_of("sf11", kHeliumD), 1.78472, 1e-5);
  // Handbook values at sodium D.
  EXPECT_NEAR(n_of("water", kD), 1.3330, 5e-4);
  EXPECT_NEAR(n_of("fused silica", kD), 1.4584, 1e-4);
  EXPECT_NEAR(n_of("fused quartz", kD), 1.4584, 1e-4);
  EXPECT_NEAR(n_of("diamond", kD), 2.4173, 2e-4);
  EXPECT_NEAR(n_of("sapphire", kD), 1.7681, 2e-4);
  EXPECT_NEAR(n_of("sodium chloride", kD), 1.5442, 2e-4);
  EXPECT_NEAR(n_of("calcium fluoride", kD), 1.4338, 1e-4);
  EXPECT_NEAR(n_of("magnesium fluoride", kD), 1.3777, 1e-4);
  EXPECT_NEAR(n_of("pmma", kD), 1.491, 1e-3);
  EXPECT_NEAR(n_of("polystyrene", kD), 1.592, 1e-3);
  EXPECT_NEAR(n_of("polycarbonate", kD), 1.585, 1e-3);
  EXPECT_NEAR(n_of("ethanol", kD), 1.3615, 5e-4);
}

TEST(Dielectrics, DisperseNormallyAndAreTransparent) {
  for (const char* name : {"water", "bk7", "fused silica", "diamond", "sapphire", "acrylic glass",
                           "polystyrene", "polycarbonate", "sodium chloride", "calcium fluoride",
                           "magnesium fluoride", "f2", "sf11", "ethanol"}) {
    const RefractiveIndex index = *find_refractive_index(name);
    EXPECT_TRUE(index.is_dispersive()) << name;
    EXPECT_FALSE(index.source().empty()) << name;
    double last = 1e9;
    for (double nm = std::max(360.0, index.min_nm()); nm <= std::min(830.0, index.max_nm()); nm += 1) {
      EXPECT_LT(index.at(nm).real(), last) << name << " at " << nm;
      EXPECT_EQ(index.at(nm).imag(), 0.0);
      last = index.at(nm).real();
    }
    // Outside its range the value at the end holds.
    EXPECT_EQ(index.at(1.0), index.at(index.min_nm())) << name;
    EXPECT_EQ(index.at(1e9), index.at(index.max_nm())) << name;
  }
}

TEST(Dielectrics, MitsubaScalarsWithoutDispersion) {
  EXPECT_EQ(n_of("bk7", 400, false), 1.5046);
  EXPECT_EQ(n_of("Water", 700, false), 1.3330);
  EXPECT_EQ(n_of("diamond", 400, false), 2.419);
  EXPECT_EQ(n_of("fused silica", 400, false), 1.458);
  EXPECT_FALSE(find_refractive_index("bk7", false)->is_dispersive());
  for (bool dispersion : {false, true}) {
    EXPECT_EQ(n_of("vacuum", 500, dispersion), 1.0);
    EXPECT_EQ(n_of("AIR", 500, dispersion), 1.000277);
    EXPECT_EQ(n_of("pet", 500, dispersion), 1.575);
    EXPECT_EQ(n_of("ice", 500, dispersion), 1.31);
    EXPECT_EQ(n_of("water ice", 500, dispersion), 1.31);
  }
  // Without a scalar of Mitsuba's: the formula at sodium D, at every wavelength.
  EXPECT_EQ(n_of("sapphire", 400, false), n_of("sapphire", kD));
}

TEST(Metals, KeepTheTabulatedNumbers) {
  const RefractiveIndex gold = *find_refractive_index("Au");
  EXPECT_EQ(gold.at(298.75705), std::complex<double>(1.795, 1.920375));
  EXPECT_EQ(gold.at(885.601257), std::complex<double>(0.21, 5.88));
  EXPECT_EQ(gold.at(100), gold.at(gold.min_nm()));
  EXPECT_EQ(gold.at(5000), gold.at(gold.max_nm()));
  EXPECT_EQ(find_refractive_index("Cu_palik")->at(309.950012), std::complex<double>(1.34, 1.72));
  EXPECT_EQ(find_refractive_index("cu_PALIK")->at(309.950012), std::complex<double>(1.34, 1.72));
  EXPECT_EQ(find_refractive_index("W", false)->at(885.570984), std::complex<double>(3.29, 2.96));
  EXPECT_TRUE(gold.is_dispersive());
  const std::complex<double> low = gold.at(298.75705);
  EXPECT_NEAR(std::abs(gold.at(298.75705 + 1e-6) - low), 0.0, 1e-6);
}

TEST(Metals, LookRight) {
  EXPECT_NEAR(reflectance("Au", 450), 0.38, 0.03);  // gold absorbs blue
  EXPECT_NEAR(reflectance("Au", 650), 0.96, 0.02);
  EXPECT_NEAR(reflectance("Cu", 450), 0.55, 0.05);
  EXPECT_NEAR(reflectance("Cu", 650), 0.95, 0.03);
  EXPECT_NEAR(reflectance("Ag", 550), 0.97, 0.02);
  EXPECT_NEAR(reflectance("Al", 550), 0.915, 0.01);
  EXPECT_NEAR(reflectance("Cr", 550), 0.65, 0.05);
  // Handbook values at sodium D: gold 0.27 + 2.95i (Johnson and Christy 1972 interpolated), silver 0.13
  // + 3.6i.
  EXPECT_NEAR(std::abs(find_refractive_index("Au")->at(kD) - std::complex<double>(0.27, 2.95)), 0, 0.05);
}

TEST(RefractiveIndices, EveryNameIsFoundOnceAndFinite) {
  std::set<std::string> seen;
  for (const std::string& name : refractive_index_names()) {
    std::string lower = name;
    std::ranges::transform(lower, lower.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    EXPECT_TRUE(seen.insert(lower).second) << name << " is ambiguous";
    for (bool dispersion : {false, true}) {
      const auto index = find_refractive_index(name, dispersion);
      ASSERT_TRUE(index.has_value()) << name;
      EXPECT_LT(index->min_nm(), index->max_nm());
      for (double nm : {10.0, 360.0, 555.0, 830.0, 1e5}) {
        const std::complex<double> n = index->at(nm);
        EXPECT_TRUE(std::isfinite(n.real()) && std::isfinite(n.imag())) << name;
        EXPECT_GT(n.real(), 0.0) << name;
        EXPECT_GE(n.imag(), 0.0) << name;
      }
    }
  }
  EXPECT_FALSE(find_refractive_index("none").has_value());
  EXPECT_FALSE(find_refractive_index("unobtainium").has_value());
  EXPECT_FALSE(find_refractive_index("").has_value());
  EXPECT_EQ(seen.count("au"), 1u);
}

}  // namespace
}  // namespace aureole
