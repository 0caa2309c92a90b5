// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/particle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "aureole/optics/particle/coated_mie.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/optics/particle/rayleigh_scattering.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

struct CoatedReference {
  double core, x;
  Complex core_index, coat_index;
  double extinction, scattering, g;
  double intensity[7];
};
#include "optics/particle/references/coated_references.inc"

TEST(CoatedMie, BohrenAndHuffman) {
  // Radii 0.171 and 6.265 um, 3 um: the test case of their program BHCOAT, appendix B.
  const double k = 2 * kPi / 3;
  const CoatedMie sphere(0.171 * k, 6.265 * k, {1.59, 0.66}, {1.409, 0.1747});
  EXPECT_NEAR(sphere.extinction(), 2.32803, 0.51e-5);
  EXPECT_NEAR(sphere.scattering(), 1.14341, 0.51e-5);
  EXPECT_NEAR(sphere.asymmetry(), 0.94340, 0.51e-5);
}

TEST(CoatedMie, AnotherProgram) {
  for (const CoatedReference& c : kCoated) {
    const CoatedMie sphere(c.core, c.x, c.core_index, c.coat_index);
    EXPECT_NEAR(sphere.extinction() / c.extinction, 1, 1e-7) << c.x;
    EXPECT_NEAR(sphere.scattering() / c.scattering, 1, 1e-7) << c.x;
    EXPECT_NEAR(sphere.asymmetry(), c.g, 1e-7) << c.x;
    const double degrees[] = {0, 10, 45, 90, 135, 170, 180};
    for (int i = 0; i < 7; ++i)
      EXPECT_NEAR(sphere.amplitudes(std::cos(degrees[i] * kPi / 180)).intensity() / c.intensity[i], 1, 1e-5)
          << c.x << " at " << degrees[i];
  }
}

TEST(CoatedMie, LimitsAreHomogeneousSpheres) {
  const auto expect_same = [](const PartialWaves& a, const PartialWaves& b, double tolerance) {
    EXPECT_NEAR(a.extinction() / b.extinction(), 1, tolerance) << b.size();
    EXPECT_NEAR(a.scattering() / b.scattering(), 1, tolerance) << b.size();
    EXPECT_NEAR(a.asymmetry(), b.asymmetry(), tolerance) << b.size();
  };
  for (const double x : {0.1, 3.0, 40.0, 900.0}) {
    expect_same(CoatedMie(0.6 * x, x, {1.4, 0.03}, {1.4, 0.03}), Mie(x, {1.4, 0.03}), 1e-10);
    expect_same(CoatedMie(x, x, {1.4, 0.03}, {1.9, 0.7}), Mie(x, {1.4, 0.03}), 1e-10);
    expect_same(CoatedMie(1e-3 * std::min(x, 1.0), x, {1.4, 0.03}, {1.9, 0.7}), Mie(x, {1.9, 0.7}), 1e-6);
    // An opaque coat hides its core, and nothing overflows.
    if (x > 20) expect_same(CoatedMie(0.5 * x, x, 1.1, {1.9, 2}), Mie(x, {1.9, 2}), 1e-10);
  }
  EXPECT_THROW(CoatedMie(2, 1, 1.3, 1.5), std::domain_error);
  EXPECT_THROW(CoatedMie(0, 1, 1.3, 1.5), std::domain_error);
  EXPECT_THROW(CoatedMie(0.5, 1, {1.3, -1}, 1.5), std::domain_error);
  EXPECT_THROW(CoatedMie(0.5, 1, 1.3, {0, 1}), std::domain_error);
  EXPECT_THROW(CoatedMie(0.5, 2e5, 1.3, 1.5), std::domain_error);
}

TEST(PartialWaves, IntensitiesAreThoseOfTheAmplitudes) {
  const Mie sphere(41.7, {1.4, 0.01});
  std::vector<double> mu;
  for (int i = 0; i < 22; ++i) mu.push_back(i / 21.0);
  std::vector<double> at(mu.size()), mirrored(mu.size());
  sphere.intensities(mu, at, mirrored);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    EXPECT_NEAR(at[i] / sphere.amplitudes(mu[i]).intensity(), 1, 1e-10);
    EXPECT_NEAR(mirrored[i] / sphere.amplitudes(-mu[i]).intensity(), 1, 1e-10);
  }
}

TEST(Particle, SquareMetres) {
  // x = 10, m = 0.75: Wiscombe's published Qext and g.
  const double radius = 10 * 500e-9 / (2 * kPi * 1.6);
  const auto sphere = sphere_kind([](double) { return Complex(1.2); })->make(radius, 500, 1.6);
  EXPECT_NEAR(sphere->extinction_efficiency(), 2.232265, 1e-6);
  EXPECT_NEAR(sphere->extinction() / (2.232265 * kPi * radius * radius), 1, 1e-6);
  EXPECT_NEAR(sphere->asymmetry(), 0.896473, 1e-6);
  // Trapezoids over the angle, of a function that is a polynomial in its cosine.
  double sum = 0;
  for (int i = 1; i < 400; ++i) {
    const double angle = kPi * i / 400;
    sum += 2 * kPi * std::sin(angle) * sphere->differential(std::cos(angle)) * kPi / 400;
  }
  EXPECT_NEAR(sum / sphere->scattering(), 1, 1e-3);
  // Far below the wavelength, where another formula takes over.
  const auto kind = sphere_kind([](double) { return Complex(1.5, 0.2); });
  for (const double mu : {-1.0, 0.2, 1.0}) {
    const double below = 0.999e-3 / (2 * kPi) * 500e-9, above = 1.001e-3 / (2 * kPi) * 500e-9;
    EXPECT_NEAR(kind->make(below, 500, 1)->differential(mu) / kind->make(above, 500, 1)->differential(mu),
                std::pow(0.999 / 1.001, 6), 1e-5);
    EXPECT_NEAR(kind->make(below, 500, 1)->absorption() / kind->make(above, 500, 1)->absorption(),
                std::pow(0.999 / 1.001, 3), 1e-5);
  }
  EXPECT_THROW(kind->make(1e-6, -500, 1), std::domain_error);
  EXPECT_THROW(kind->make(1e-6, 500, 0), std::domain_error);
}

TEST(Particle, CoatsByFractionAndThickness) {
  const auto core = [](double) { return Complex(1.33); };
  const auto coat = [](double) { return Complex(1.5, 0.1); };
  const auto by_fraction = coated_sphere_kind(core, coat, 0.8)->make(1e-6, 500, 1);
  const auto by_thickness = thin_coated_sphere_kind(core, coat, 0.2e-6)->make(1e-6, 500, 1);
  EXPECT_NEAR(by_fraction->extinction() / by_thickness->extinction(), 1, 1e-12);
  const auto all_coat = thin_coated_sphere_kind(core, coat, 0.2e-6)->make(0.1e-6, 500, 1);
  EXPECT_NEAR(all_coat->extinction() / sphere_kind(coat)->make(0.1e-6, 500, 1)->extinction(), 1, 1e-12);
  EXPECT_THROW(coated_sphere_kind(core, coat, 1), std::domain_error);
  EXPECT_THROW(thin_coated_sphere_kind(core, coat, 0), std::domain_error);
}

TEST(Rayleigh, SmallSpheresAreMies) {
  for (const Complex m : {Complex(1.33), Complex(0.75), Complex(1.5, 0.4), Complex(2, 1.5)})
    for (const double x : {0.03, 0.1}) {
      const double radius = x * 500e-9 / (2 * kPi);
      const RayleighSphere small(radius, 500, m, 1);
      const Mie exact(x, m);
      // Two terms: the rest is of order x^3 (complex) or x^4.
      const double tolerance = m.imag() > 0 ? 8 * std::pow(x, 3) : 4 * std::pow(x, 4);
      EXPECT_NEAR(small.scattering_efficiency() / exact.scattering(), 1, tolerance + 1e-12) << m << x;
      if (m.imag() > 0) {
        const double absorbed = exact.extinction() - exact.scattering();
        EXPECT_NEAR(small.absorption_efficiency() / absorbed, 1, tolerance) << m << x;
      }
    }
}

TEST(Rayleigh, PhaseFunctionAndDepolarization) {
  for (const double rho : {0.0, 0.03, 0.3, 0.8}) {
    // Simpson's rule is exact for a parabola.
    const double sum =
        2 * kPi / 3 * (rayleigh_phase(-1, rho) + 4 * rayleigh_phase(0, rho) + rayleigh_phase(1, rho));
    EXPECT_NEAR(sum, 1, 1e-14);
    // At a right angle, rho is the ratio of the intensities along and across: (1 + 3 g)/(1 - g) there is
    // (1 + rho)/(1 - rho) of the phase function at 90 degrees over its growth to 0.
    EXPECT_NEAR(rayleigh_phase(0, rho) / (rayleigh_phase(1, rho) - rayleigh_phase(0, rho)),
                (1 + rho) / (1 - rho), 1e-12);
  }
  EXPECT_NEAR(king_factor(0), 1, 0);
  EXPECT_NEAR(king_factor(0.0279), 1.0480, 1e-4);  // Young 1981: air
  EXPECT_THROW(rayleigh_phase(0, -0.1), std::domain_error);
  EXPECT_THROW(rayleigh_phase(0, 0.9), std::domain_error);
  EXPECT_THROW(RayleighSphere(-1e-9, 500, 1.5, 1), std::domain_error);
}

TEST(Rayleigh, AirAndWater) {
  // The fit that Bodhaine et al. 1999 give for their own calculation (equation 29, 0.25 to 0.85 um, within 0.01 %).
  for (const double lambda : {0.3, 0.4, 0.55, 0.7, 0.85}) {
    const double l2 = lambda * lambda;
    const double fit =
        1e-32 * (1.0455996 - 341.29061 / l2 - 0.90230850 * l2) / (1 + 0.0027059889 / l2 - 85.968563 * l2);
    EXPECT_NEAR(air_cross_section(1000 * lambda) / fit, 1, 1e-3) << lambda;
    EXPECT_NEAR(king_factor(air_depolarization(1000 * lambda)), air_king_factor(1000 * lambda), 1e-12);
  }
  // Morel 1974, table 4: 34.9e-4, 22.2e-4 and 14.9e-4 /m at 450, 500 and 550 nm; 1 + 0.835 mu^2.
  EXPECT_NEAR(water_scattering(450), 34.9e-4, 0.7e-4);
  EXPECT_NEAR(water_scattering(500), 22.2e-4, 0.4e-4);
  EXPECT_NEAR(water_scattering(550), 14.9e-4, 0.1e-4);
  EXPECT_NEAR(rayleigh_phase(1, kWaterDepolarization) / rayleigh_phase(0, kWaterDepolarization), 1.835, 1e-3);
}

}  // namespace
}  // namespace aureole::optics
