// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/ensemble.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "aureole/optics/particle/hard_spheres.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

SpectralFunction constant(double value) {
  return [=](double) { return value; };
}
std::shared_ptr<const ParticleKind> spheres(Complex index) {
  return sphere_kind([=](double) { return index; });
}

struct AverageReference {
  RadiusDistribution radii;
  double lambda, medium;
  Complex index;
  double extinction, scattering, g;
  double phase[7];
};

TEST(Ensemble, AveragesOfAnotherProgram) {
#include "optics/particle/references/average_references.inc"
  for (const AverageReference& r : kAverages) {
    const Ensemble e({{spheres(r.index), r.radii}}, {r.lambda}, constant(r.medium));
    const EnsembleCoefficients& c = e.coefficients()[0];
    EXPECT_TRUE(c.converged);
    EXPECT_NEAR(c.extinction() * 1e12 / r.extinction, 1, 1e-3) << r.lambda;
    EXPECT_NEAR(c.scattering * 1e12 / r.scattering, 1, 1e-3) << r.lambda;
    EXPECT_NEAR(c.asymmetry / r.g, 1, 1e-3) << r.lambda;
    const PhaseTable phase = e.phases().tables[0];
    EXPECT_NEAR(phase.asymmetry(), r.g, 1e-3);
    const double degrees[] = {0, 10, 45, 90, 135, 170, 180};
    for (int i = 0; i < 7; ++i) {
      const double mu = std::cos(degrees[i] * kPi / 180);
      // Errors of the other program's table here: averaging 5e-3, interpolation and normalisation 5e-3.
      EXPECT_NEAR(phase.eval(mu) / r.phase[i], 1, 1e-2) << r.lambda << " at " << degrees[i];
      EXPECT_NEAR(e.differential(0, std::span(&mu, 1))[0] / c.scattering / r.phase[i], 1, 6e-3) << degrees[i];
    }
  }
}

TEST(Ensemble, CloudC1) {
  // Deirmendjian 1969: 100 droplets per cm^3 have 16.33 /km at 0.45 um and 16.73 /km at 0.7 um (his sums are
  // coarser).
  const Ensemble cloud({{spheres(1.34), RadiusDistribution::modified_gamma(4e-6, 6, 1), 100e6}}, {450, 700},
                       constant(1));
  EXPECT_NEAR(cloud.coefficients()[0].scattering, 16.33e-3, 0.015 * 16.33e-3);
  EXPECT_NEAR(cloud.coefficients()[1].scattering, 16.73e-3, 0.015 * 16.73e-3);
  EXPECT_GT(cloud.coefficients()[0].asymmetry, 0.84);
  EXPECT_LT(cloud.coefficients()[0].asymmetry, 0.87);
}

TEST(Ensemble, MixturesAddUp) {
  const auto small = RadiusDistribution::log_normal(0.05e-6, 0.3),
             large = RadiusDistribution::log_normal(0.6e-6, 0.2);
  const ParticlePopulation a{spheres(1.5), small, 3e16}, b{spheres({1.4, 0.02}), large, 2e14};
  const std::vector<double> lambda{450, 650};
  const Ensemble both({a, b}, lambda, constant(1.33)), first({a}, lambda, constant(1.33)),
      second({b}, lambda, constant(1.33));
  const PhaseTables phases = both.phases();
  EXPECT_EQ(phases.tables[0].mu, phases.tables[1].mu);
  for (int w = 0; w < 2; ++w) {
    const auto &c = both.coefficients()[w], &c1 = first.coefficients()[w], &c2 = second.coefficients()[w];
    EXPECT_NEAR(c.scattering / (c1.scattering + c2.scattering), 1, 1e-12);
    EXPECT_NEAR(c.absorption / (c1.absorption + c2.absorption), 1, 1e-12);
    EXPECT_NEAR(c.asymmetry * c.scattering / (c1.asymmetry * c1.scattering + c2.asymmetry * c2.scattering), 1,
                1e-12);
    const double mu[] = {-0.7, 0.9};
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(
          both.differential(w, mu)[i] / (first.differential(w, mu)[i] + second.differential(w, mu)[i]), 1,
          1e-12);
    EXPECT_NEAR(phases.tables[w].integral(), 1, 1e-12);
    EXPECT_NEAR(phases.integrals[w] / c.scattering, 1, 2e-3);
    EXPECT_NEAR(phases.tables[w].asymmetry(), c.asymmetry, 1e-3);
  }
}

TEST(Ensemble, ThreadsDoNotChangeABit) {
  const ParticlePopulation p{spheres({1.33, 1e-6}), RadiusDistribution::gamma(3e-6, 0.1)};
  const Ensemble one({p}, {450, 650}, constant(1)), two({p}, {450, 650}, constant(1), {}, std_thread_for(3));
  EXPECT_EQ(one.coefficients()[1].scattering, two.coefficients()[1].scattering);
  const PhaseTables a = one.phases(), b = two.phases(std_thread_for(3));
  EXPECT_EQ(a.tables[0].mu, b.tables[0].mu);
  EXPECT_EQ(a.tables[1].p, b.tables[1].p);
}

TEST(Ensemble, TellsItsProgress) {
  const Ensemble e({{spheres(1.33), RadiusDistribution::gamma(4e-6, 0.1)}}, {450, 600}, constant(1));
  std::vector<double> parts;
  const PhaseTables told = e.phases(serial_for, [&](double part) { parts.push_back(part); });
  ASSERT_GT(parts.size(), 10u);
  EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
  EXPECT_GT(parts.front(), 0);
  EXPECT_GT(parts.back(), 0.85);
  EXPECT_LE(parts.back(), 1);
  EXPECT_EQ(told.tables[0].p, e.phases().tables[0].p);
  struct Enough {};
  EXPECT_THROW(e.phases(std_thread_for(2),
                        [&](double part) {
                          if (part > 0.2) throw Enough();
                        }),
               Enough);
}

TEST(Ensemble, AveragingConverges) {
  // The claim in EnsembleAccuracy: twice as many radii until nothing changes leaves errors of about a third.
  const ParticlePopulation p{spheres(1.335), RadiusDistribution::gamma(5e-6, 0.05)};
  EnsembleAccuracy fine;
  fine.averaging = 1e-5, fine.phase_averaging = 1e-3;
  const Ensemble standard({p}, {550}, constant(1)), exact({p}, {550}, constant(1), fine);
  EXPECT_GT(exact.coefficients()[0].radii, 2 * standard.coefficients()[0].radii);
  EXPECT_NEAR(standard.coefficients()[0].scattering / exact.coefficients()[0].scattering, 1, 1e-3);
  EXPECT_NEAR(standard.coefficients()[0].asymmetry / exact.coefficients()[0].asymmetry, 1, 1e-3);
  std::vector<double> mu;
  for (int i = 0; i <= 60; ++i) mu.push_back(std::cos(kPi * i / 60));
  const auto a = standard.differential(0, mu), b = exact.differential(0, mu);
  double squares = 0;
  for (std::size_t i = 0; i < mu.size(); ++i) squares += std::pow(a[i] / b[i] - 1, 2);
  const double rms = std::sqrt(squares / double(mu.size()));
  std::printf("%zu and %zu radii: rms of the phase function %.2g\n", standard.coefficients()[0].radii,
              exact.coefficients()[0].radii, rms);
  EXPECT_LT(rms, 6e-3);
}

TEST(HardSpheres, StructureFactor) {
  for (const double f : {0.024, 0.15, 0.3, 0.5}) {
    const double s0 = std::pow(1 - f, 4) / std::pow(1 + 2 * f, 2);
    EXPECT_NEAR(hard_sphere_structure_factor(0, f), s0, 1e-13);
    EXPECT_NEAR(hard_sphere_structure_factor(1e-4, f), s0, 1e-6);
    // Series and closed form meet at u = 1.
    EXPECT_NEAR(hard_sphere_structure_factor(1 - 1e-9, f), hard_sphere_structure_factor(1 + 1e-9, f), 1e-7);
    EXPECT_NEAR(hard_sphere_structure_factor(200, f), 1, 1e-3);
  }
  // To first order in f: 1 - 24 f (sin A - A cos A)/A^3, the transform of the excluded volume.
  for (const double u : {0.3, 1.7, 5.0}) {
    const double a = 2 * u;
    EXPECT_NEAR((hard_sphere_structure_factor(u, 1e-6) - 1) / 1e-6,
                -24 * (std::sin(a) - a * std::cos(a)) / (a * a * a), 1e-3);
  }
  EXPECT_EQ(hard_sphere_structure_factor(1, 0), 1);
  EXPECT_THROW(hard_sphere_structure_factor(1, 0.61), std::domain_error);
  EXPECT_THROW(hard_sphere_structure_factor(1, -0.1), std::domain_error);
}

/// g(r) of Percus and Yevick's theory just outside of contact is (1 + f/2)/(1 - f)^2; inside it is 0 (Wertheim
/// 1963). S is its transform: back by quadrature.
TEST(HardSpheres, PairCorrelationComesBack) {
  const double f = 0.3;
  const auto g = [&](double r) {  // r in radii
    double sum = 0;
    const double step = 0.005, end = 400;
    for (double u = step / 2; u < end; u += step)
      sum += u * std::sin(u * r) * (hard_sphere_structure_factor(u, f) - 1) *
             std::exp(-2 * std::pow(u / end, 2)) * step;
    // rho = f/(4/3 pi) per radius^3.
    return 1 + sum / (2 * kPi * kPi * r) / (f / (4 * kPi / 3));
  };
  EXPECT_NEAR(g(1.0), 0, 0.02);
  EXPECT_NEAR(g(1.9), 0, 0.02);
  EXPECT_NEAR(g(2.02), (1 + f / 2) / ((1 - f) * (1 - f)), 0.1);
  EXPECT_NEAR(g(12), 1, 0.01);
}

TEST(Ensemble, DependentScatteringOfDenseSuspensions) {
  // Rutile in a binder, 15 %: three figures by another program.
  const auto pigment = RadiusDistribution::monodisperse(0.12e-6);
  ParticlePopulation p{spheres(2.73), pigment, 0.15 / pigment.mean_volume()};
  const DependentScattering rutile = dependent_scattering(p, 550, 1.5);
  EXPECT_NEAR(rutile.scattering, 0.654, 1e-3);
  EXPECT_NEAR(rutile.reduced, 0.922, 1e-3);
  const Ensemble without({p}, {550}, constant(1.5));
  p.hard_spheres = true;
  const Ensemble with({p}, {550}, constant(1.5));
  EXPECT_NEAR(without.coefficients()[0].asymmetry, 0.538, 1e-3);
  EXPECT_NEAR(with.coefficients()[0].asymmetry, 0.349, 1e-3);
  EXPECT_NEAR(with.coefficients()[0].independent_scattering, without.coefficients()[0].scattering, 1e-9);
  EXPECT_NEAR(with.phases().tables[0].asymmetry(), 0.349, 2e-3);
  // Micelles of casein, 2.4 % in water; thin suspensions do not mind.
  const auto micelles = RadiusDistribution::monodisperse(43e-9);
  ParticlePopulation casein{spheres(1.503), micelles, 0.024 / micelles.mean_volume()};
  EXPECT_NEAR(dependent_scattering(casein, 550, 1.333).scattering, 0.867, 1e-3);
  casein.number_density *= 1e-3;
  EXPECT_NEAR(dependent_scattering(casein, 550, 1.333).scattering, 1, 2e-4);
}

TEST(Ensemble, BadInputIsNamed) {
  const auto radii = RadiusDistribution::monodisperse(1e-6);
  EXPECT_THROW(Ensemble({{spheres(1.5), radii, -1}}, {500}, constant(1)), std::domain_error);
  EXPECT_THROW(Ensemble({{spheres(1.5), radii, 1}}, {-500}, constant(1)), std::domain_error);
  EXPECT_THROW(Ensemble({{spheres(1.5), radii, 1}}, {500}, constant(0)), std::domain_error);
  EXPECT_THROW(Ensemble({{spheres(1.5), radii, 0.7 / radii.mean_volume(), true}}, {500}, constant(1)),
               std::domain_error);
  EXPECT_THROW(Ensemble({{spheres(1.5), radii, 0}}, {500}, constant(1)).phases(), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
