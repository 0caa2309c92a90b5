// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/medium/suspension_model.h"
#include "aureole/optics/particle/rayleigh_scattering.h"

namespace aureole::optics {
namespace {

std::shared_ptr<const ParticleKind> glass() {
  return sphere_kind([](double) { return std::complex<double>(1.5); });
}
ClearMedium liquid() {
  return {.index = spectral_constant(1.33), .absorption = spectral_constant(0.5), .density = 1000};
}
Ingredient beads(Amount amount, double density = 2500) {
  return {.name = "beads",
          .particles = glass(),
          .radii = RadiusDistribution::log_normal(0.5e-6, 0.2),
          .amount = amount,
          .density = density};
}
void expect_error(const std::function<void()>& f, const std::string& part) {
  try {
    f();
    ADD_FAILURE() << part;
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(Suspension, AmountsAreThreeWaysToSayOneThing) {
  const Suspension by_volume(liquid(), {beads({Amount::Kind::volume, 0.02})});
  EXPECT_NEAR(by_volume.volume_fraction(), 0.02, 1e-15);
  EXPECT_NEAR(by_volume.density(), 0.02 * 2500 + 0.98 * 1000, 1e-9);
  const Suspension by_mass(liquid(), {beads({Amount::Kind::mass, 0.02 * 2500 / 1030})});
  EXPECT_NEAR(by_mass.volume_fraction(), 0.02, 1e-12);
  const Suspension by_number(liquid(), {beads({Amount::Kind::number, by_volume.number_density(0)})});
  EXPECT_NEAR(by_number.volume_fraction(), 0.02, 1e-12);
  // Three kinds at once, two of them by mass: the masses come back.
  Ingredient light = beads({Amount::Kind::mass, 0.1}, 900), dense = beads({Amount::Kind::mass, 0.2}, 4000);
  const Suspension mixed(liquid(), {light, beads({Amount::Kind::volume, 0.05}), dense});
  EXPECT_NEAR(mixed.volume_fraction(0) * 900 / mixed.density(), 0.1, 1e-12);
  EXPECT_NEAR(mixed.volume_fraction(2) * 4000 / mixed.density(), 0.2, 1e-12);
  EXPECT_NEAR(mixed.volume_fraction(1), 0.05, 1e-12);
}

TEST(Suspension, HostAndParticlesAddUp) {
  const Suspension s(liquid(), {beads({Amount::Kind::volume, 0.02})});
  const MediumSpectrum m = s.spectrum({450, 600});
  ASSERT_EQ(m.phases.tables.size(), 2u);
  EXPECT_EQ(m.phases.tables[0].mu, m.phases.tables[1].mu);
  for (const auto& c : m.coefficients) {
    EXPECT_NEAR(c.absorption, 0.98 * 0.5, 1e-9);
    // Number times cross section, by one's own sum over radii.
    double mean = 0, weight = 0;
    for (int i = -400; i <= 400; ++i) {
      const double z = i * 0.01, r = 0.5e-6 * std::exp(0.2 * z), w = std::exp(-0.5 * z * z);
      mean += w * glass()->make(r, c.lambda_nm, 1.33)->scattering(), weight += w;
    }
    EXPECT_NEAR(c.scattering / (s.number_density(0) * mean / weight), 1, 1e-3);
  }
  EXPECT_NEAR(m.phases.tables[1].asymmetry(), m.coefficients[1].asymmetry, 2e-3);
  EXPECT_TRUE(s.spectrum({450}, false).phases.tables.empty());
}

TEST(Suspension, MoleculesScatterToo) {
  const MediumSpectrum m = Suspension(water(), {}).spectrum({500});
  EXPECT_NEAR(m.coefficients[0].scattering, 22.2e-4, 0.4e-4);
  EXPECT_NEAR(m.coefficients[0].absorption, 0.0204, 1e-9);
  ASSERT_EQ(m.phases.tables.size(), 1u);
  for (const double mu : {-1.0, 0.0, 0.7})
    EXPECT_NEAR(m.phases.tables[0].eval(mu) / rayleigh_phase(mu, kWaterDepolarization), 1, 3e-3);
  // A lossless liquid without molecules has no phase function, and no error.
  EXPECT_TRUE(Suspension(liquid(), {}).spectrum({500}).phases.tables.empty());
}

TEST(Suspension, DependenceIsToldWhetherItIsOnOrOff) {
  const Suspension off(liquid(), {beads({Amount::Kind::volume, 0.2})});
  Ingredient packed = beads({Amount::Kind::volume, 0.2});
  packed.hard_spheres = true;
  const Suspension on(liquid(), {packed});
  const auto told = off.dependence(0, 550);
  ASSERT_TRUE(told);
  EXPECT_LT(told->scattering, 0.99);
  const EnsembleCoefficients c = on.spectrum({550}, false).coefficients[0];
  const EnsembleCoefficients c0 = off.spectrum({550}, false).coefficients[0];
  EXPECT_NEAR(c.scattering / c0.scattering, told->scattering, 1e-9);
  EXPECT_NEAR(c.scattering * (1 - c.asymmetry) / (c0.scattering * (1 - c0.asymmetry)), told->reduced, 1e-9);
}

TEST(Solution, DyesAddUp) {
  const Dye red{"red", spectral_constant(20000), 1e-5}, blue{"blue", spectral_constant(5000), 4e-5};
  const Solution s(liquid(), {red, blue});
  EXPECT_NEAR(s.absorption(500), 0.5 + 2.302585092994046 * 100 * (0.2 + 0.2), 1e-9);
  EXPECT_EQ(s.index(500), 1.33);
  const Suspension cloudy(s.medium(), {beads({Amount::Kind::volume, 1e-3})});
  EXPECT_NEAR(cloudy.spectrum({500}, false).coefficients[0].absorption, 0.999 * s.absorption(500), 1e-6);
  expect_error([&] { Solution(liquid(), {{"red", spectral_constant(1), -1}}); }, "red");
  expect_error([&] { Solution(liquid(), {{"red", nullptr, 1}}); }, "absorptivity");
  expect_error([&] { Solution({}, {}); }, "index");
}

TEST(Solution, Riboflavin) {
  const auto e = riboflavin_absorptivity();
  // Its peak near 450 nm: 12200 L/(mol cm) in the literature (Koziol 1966), this coarse table 20 % less.
  EXPECT_GT(e(450), 9000);
  EXPECT_LT(e(450), 12500);
  EXPECT_EQ(e(650), 0);
}

TEST(SpectralTable, InterpolatesAndChecks) {
  const SpectralPoint points[] = {{400, 1}, {500, 3}};
  const auto f = spectral_table(points);
  EXPECT_EQ(f(300), 1);
  EXPECT_NEAR(f(425), 1.5, 1e-14);
  EXPECT_EQ(f(900), 3);
  const SpectralPoint unordered[] = {{500, 1}, {400, 3}}, negative[] = {{400, -1}};
  EXPECT_THROW(spectral_table({}), std::domain_error);
  EXPECT_THROW(spectral_table(unordered), std::domain_error);
  EXPECT_THROW(spectral_table(negative), std::domain_error);
}

TEST(Suspension, BadInputIsNamed) {
  expect_error([] { Suspension(liquid(), {beads({Amount::Kind::volume, -0.1})}); }, "beads");
  expect_error([] { Suspension(liquid(), {beads({Amount::Kind::volume, 0.8})}); }, "more particles than fit");
  expect_error(
      [] {
        Suspension(liquid(), {beads({Amount::Kind::volume, 0.4}), beads({Amount::Kind::volume, 0.4})});
      },
      "0.8");
  expect_error(
      [] {
        Suspension(liquid(), {beads({Amount::Kind::mass, 0.1}, 0)});
      },
      "density of its material");
  expect_error(
      [] {
        Suspension({.index = spectral_constant(1)}, {beads({Amount::Kind::mass, 0.1})});
      },
      "density of the medium");
  expect_error([] { Suspension(liquid(), {beads({Amount::Kind::mass, 1.1})}); }, "[0, 1]");
  expect_error([] { Suspension({}, {}); }, "index");
  Ingredient packed = beads({Amount::Kind::volume, 0.65});
  packed.hard_spheres = true;
  expect_error([&] { Suspension(liquid(), {packed}); }, "0.6");
  packed.particles = nullptr;
  expect_error([&] { Suspension(liquid(), {packed}); }, "no particles");
}

}  // namespace
}  // namespace aureole::optics
