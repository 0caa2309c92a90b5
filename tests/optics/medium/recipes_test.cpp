// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/recipes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/medium/half_space.h"

namespace aureole::optics {
namespace {

TEST(Recipes, SkimMilk) {
  // The fat of skim milk: 258 /m at 550 nm by an own implementation of the paper; 404 /m where its sizes are taken
  // by number.
  const Suspension fat = milk({.fat = 0.1, .protein = 0});
  EXPECT_NEAR(fat.spectrum({550}, false).coefficients[0].scattering, 258, 0.03 * 258);
  EXPECT_NEAR(fat.volume_fraction(), 0.1 / 100 * 1030 / 915, 1e-12);
}

TEST(Recipes, MilkByFatContent) {
  double before = 0;
  for (const double fat : {0.1, 1.5, 3.0}) {
    const auto c = milk({.fat = fat, .pressure = 20}).spectrum({450, 550, 650}, false).coefficients;
    // More fat, more light: blue most of all, and riboflavin takes from the blue.
    EXPECT_GT(c[1].scattering, 1.5 * before);
    EXPECT_GT(c[0].scattering, c[2].scattering);
    EXPECT_GT(c[0].absorption, 2 * c[1].absorption);
    std::printf("%.1f %% fat: ", fat);
    for (const auto& one : c)
      std::printf(" %g nm sigma_s %.0f sigma_a %.2f g %.3f;", one.lambda_nm, one.scattering, one.absorption,
                  one.asymmetry);
    std::printf("\n");
    before = c[1].scattering;
  }
  // Casein alone, and what the micelles' distances change (12 % less).
  const Suspension casein = milk({.fat = 0, .protein = 3.4});
  EXPECT_NEAR(casein.volume_fraction(), 0.024, 1e-4);
  EXPECT_NEAR(casein.dependence(0, 550)->scattering, 0.877, 0.005);
  const auto alone = milk({.fat = 0, .hard_spheres = true}).spectrum({550}, false).coefficients[0];
  EXPECT_NEAR(alone.scattering / alone.independent_scattering, 0.877, 0.005);
  // Homogenisation makes globules smaller, as a power of the pressure.
  EXPECT_NEAR(milk_fat_radius(3, 50), 0.219e-6, 0.001e-6);
  EXPECT_LT(milk_fat_radius(3, 50), milk_fat_radius(3, 10));
  EXPECT_NEAR(milk_fat_radius(3, 1) / milk_fat_radius(3, 0), 1, 1e-12);
  EXPECT_THROW(milk({.fat = -1}), std::domain_error);
  EXPECT_THROW(milk({.fat = 60}), std::domain_error);
  EXPECT_THROW(milk({.pressure = -3}), std::domain_error);
}

TEST(Recipes, MilkAbsorbsAndReflectsAsMeasured) {
  // sigma_a in 1/m at red, green and blue of a camera: Jensen et al. 2001 and Narasimhan et al. 2006 (milk with 1,
  // 2 and 3.3 % of fat). Milks differ by up to a factor of 2; a fifth more is left for the width of the channels.
  const struct {
    double fat, measured[3][2];
  } published[] = {{0.1, {{1.4, 1.4}, {2.5, 2.5}, {14.2, 14.2}}},
                   {1.0, {{1.4, 2.9}, {2.5, 5.75}, {11.5, 14.2}}},
                   {3.3, {{1.1, 1.53}, {2.4, 4.6}, {14, 19.9}}}};
  const double nm[] = {460, 540, 620};
  for (const auto& p : published) {
    const auto c = milk({.fat = p.fat, .pressure = 15}).spectrum({nm[0], nm[1], nm[2]}, false).coefficients;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(c[std::size_t(2 - i)].absorption, p.measured[i][0] / 1.2) << p.fat << " " << nm[2 - i];
      EXPECT_LT(c[std::size_t(2 - i)].absorption, p.measured[i][1] * 1.2) << p.fat << " " << nm[2 - i];
    }
  }
  // Diffuse reflectance in green light: 0.81 of skim and 0.88 of whole milk (Jensen et al. 2001), which is
  // homogenised. Whole milk is whiter whether it is homogenised or not, at all wavelengths without riboflavin.
  const auto reflectance = [](double fat, double pressure, double lambda_nm) {
    const auto c = milk({.fat = fat, .pressure = pressure}).spectrum({lambda_nm}, false).coefficients[0];
    const double reduced = c.scattering * (1 - c.asymmetry);
    return half_space_reflectance(reduced / (reduced + c.absorption), 1.33, Illumination::normal);
  };
  std::printf("green reflectance: skim %.3f, whole %.3f, whole and not homogenised %.3f\n",
              reflectance(0.1, 15, 540), reflectance(3.3, 15, 540), reflectance(3.3, 0, 540));
  EXPECT_NEAR(reflectance(0.1, 15, 540), 0.81, 0.03);
  EXPECT_NEAR(reflectance(3.3, 15, 540), 0.88, 0.03);
  for (const double lambda : {540.0, 580.0, 620.0, 660.0})
    for (const double pressure : {0.0, 15.0}) {
      EXPECT_GT(reflectance(3, pressure, lambda), reflectance(1.5, pressure, lambda)) << lambda;
      EXPECT_GT(reflectance(1.5, pressure, lambda), reflectance(0.1, pressure, lambda)) << lambda;
    }
}

TEST(Recipes, FogsAndClouds) {
  // Extinction at 550 nm in 1/km and liquid water in g/m^3 (Shettle & Fenn 1979): 28.74, 0.37; 18.65, 0.19; 8.68,
  // 0.02 (0.0156 before rounding). Their indices are 1 % from these.
  const struct {
    const char* name;
    double extinction, water;
  } published[] = {{"heavy_advection_fog", 28.74, 0.37},
                   {"moderate_advection_fog", 18.65, 0.19},
                   {"moderate_radiation_fog", 8.68, 0.0156}};
  EnsembleAccuracy coarse;
  coarse.phase_averaging = 1;  // coefficients alone
  for (const auto& p : published) {
    const Suspension fog = droplets(p.name);
    const auto c = fog.spectrum({550}, false, coarse).coefficients[0];
    EXPECT_NEAR(c.extinction() * 1e3, p.extinction, 0.012 * p.extinction) << p.name;
    EXPECT_NEAR(fog.volume_fraction() * 1e6, p.water, 0.02 * p.water) << p.name;
    EXPECT_GT(c.albedo(), 0.9999);
  }
  EXPECT_NEAR(droplets("c1", 50e6).volume_fraction() / droplets("c1").volume_fraction(), 0.5, 1e-12);
  try {
    droplets("mist");
    FAIL();
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("heavy_radiation_fog"), std::string::npos) << e.what();
  }
  EXPECT_THROW(droplets("c1", -1), std::domain_error);
}

TEST(Recipes, Smoke) {
  // OPAC's soot at 550 nm: albedo 0.209, asymmetry 0.337 (Hess et al. 1998). So much of it that the air between
  // does not count.
  const auto c = smoke(1e-3).spectrum({550}, false).coefficients[0];
  EXPECT_NEAR(c.albedo(), 0.209, 0.002);
  EXPECT_NEAR(c.asymmetry, 0.337, 0.002);
  EXPECT_THROW(smoke(0), std::domain_error);
}

TEST(Recipes, WaterAndAir) {
  // Blue water: 20 m of it pass 740 times as much blue as red light; Rayleigh's sky.
  const auto w = Suspension(water(), {}).spectrum({450, 650}, false).coefficients;
  EXPECT_NEAR(w[0].absorption, 0.00922, 1e-12);
  EXPECT_NEAR(w[1].absorption, 0.340, 1e-12);
  EXPECT_NEAR(water().index(589.3), 1.33336, 2e-4);
  const auto a = Suspension(air(), {}).spectrum({550}, false).coefficients[0];
  // Bucholtz 1995: 4.513e-31 m^2 for each of 2.5469e25 molecules at 550 nm.
  EXPECT_NEAR(a.scattering, 1.149e-5, 0.005e-5);
}

}  // namespace
}  // namespace aureole::optics
