// SPDX-License-Identifier: Apache-2.0
// Reflectance of half-spaces against published numbers and identities, and the dipole against quadrature.
#include "aureole/optics/medium/half_space.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/exp_sinh.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "aureole/optics/medium/diffusion_dipole.h"
#include "aureole/optics/medium/diffusion_width.h"
#include "aureole/optics/medium/single_scattering.h"

namespace aureole::optics {
namespace {

/// With what the boundary reflects.
double along_normal(double albedo, double index) {
  const double r = (index - 1) / (index + 1), f = r * r;
  return f + (1 - f) * half_space_reflectance(albedo, index, Illumination::normal);
}

/// Values of adding-doubling and discrete-ordinate programs (tests/medium/slab_test.cpp).
TEST(HalfSpace, ReflectsAsOtherPrograms) {
  EXPECT_NEAR(along_normal(.9, 1), .414947, 1e-6);
  EXPECT_NEAR(along_normal(.99, 1), .752721, 1e-6);
  EXPECT_NEAR(along_normal(.9, 1.5), .259919, 1e-6);
  // A uniform sky: R_inf of isotropic scattering by exact transport, as Kubelka-Munk coefficients are judged
  // by.
  EXPECT_NEAR(half_space_reflectance(.5, 1, Illumination::diffuse), .1465, 5e-5);
  EXPECT_NEAR(half_space_reflectance(.9, 1, Illumination::diffuse), .4780, 5e-5);
}

TEST(HalfSpace, LosesNothingWithoutAbsorption) {
  for (const double index : {0.7, 1.0, 1.33, 2.5})
    for (const Illumination i : {Illumination::normal, Illumination::diffuse}) {
      EXPECT_NEAR(half_space_reflectance(1, index, i), 1, 1e-6) << index;
      EXPECT_EQ(half_space_reflectance(0, index, i), 0);
    }
}

TEST(HalfSpace, RefusesWhatIsNone) {
  EXPECT_THROW(half_space_reflectance(1.1, 1, Illumination::normal), std::domain_error);
  EXPECT_THROW(half_space_reflectance(-0.1, 1, Illumination::normal), std::domain_error);
  EXPECT_THROW(half_space_reflectance(NAN, 1, Illumination::normal), std::domain_error);
  EXPECT_THROW(half_space_reflectance(0.5, 0, Illumination::normal), std::domain_error);
}

TEST(Dipole, ProfileIntegratesToItsClosedForm) {
  boost::math::quadrature::exp_sinh<double> integrator;
  for (const double index : {1.0, 1.3, 1.5})
    for (const double absorption : {0.001, 0.1, 2.0}) {
      const Dipole d(diffusion_coefficients(absorption, 10, 0.5), index);
      const double integral =
          integrator.integrate([&](double r) { return 2 * std::numbers::pi * r * d.profile(r); }, 1e-10);
      EXPECT_NEAR(integral, d.total(), 1e-6 * d.total());
      EXPECT_NEAR(d.total(), dipole_reflectance(d.albedo(), index), 1e-12);
      EXPECT_NEAR(dipole_albedo(d.total(), index), d.albedo(), 1e-9);
    }
  EXPECT_NEAR(dipole_reflectance(1, 1.5), 1, 1e-12);
}

/// A of Jensen et al. 2001 by their fit of the diffuse reflectance, which is good to 1 %.
TEST(Dipole, ImageStandsWhereThePublishedFitPutsIt) {
  const double n = 1.3, f = -1.440 / (n * n) + 0.710 / n + 0.668 + 0.0636 * n;
  const Dipole d(diffusion_coefficients(0.01, 1, 0), n);
  EXPECT_NEAR(d.image_height() * 1.01, 1 + 4. / 3 * (1 + f) / (1 - f), 0.02 * d.image_height());
}

TEST(Dipole, RefusesWhatIsNone) {
  EXPECT_THROW(Dipole(diffusion_coefficients(0, 0, 0), 1.5), std::domain_error);
  EXPECT_THROW(Dipole(diffusion_coefficients(1, 1, 0), -1), std::domain_error);
  EXPECT_THROW(dipole_albedo(1.1, 1.5), std::domain_error);
}

/// By the depth at which the beam is scattered, and in all by H functions' first order: without internal
/// reflection the isotropic total is albedo/2 (1 - ln 2).
TEST(SingleScattering, IsTheIntegralOverDepths) {
  EXPECT_NEAR(SingleScattering(0, 1).total(), (1 - std::numbers::ln2) / 2, 1e-5);
  boost::math::quadrature::exp_sinh<double> integrator;
  for (const double g : {0.0, 0.8, -0.4})
    for (const double n : {1.0, 1.5})
      for (const double x : {0.05, 0.5, 2.0}) {
        const SingleScattering s(g, n);
        const double first =
            n > 1 ? x * std::sqrt(n * n - 1) : 0;  // nearer the surface all is reflected back
        const double expected = integrator.integrate([&](double beyond) {
          const double t = first + beyond, d = std::hypot(x, t), c = t / d;
          if (!(d < 1e3)) return 0.0;
          const double sine = n * x / d, out = std::sqrt(std::max(0.0, 1 - sine * sine));
          const double rs = (n * c - out) / (n * c + out), rp = (c - n * out) / (c + n * out);
          const double p = (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g + 2 * g * c, 1.5));
          return std::exp(-t - d) * p * c * (1 - (rs * rs + rp * rp) / 2) / (d * d);
        });
        EXPECT_NEAR(s.profile(x), expected, 3e-3 * expected) << g << " " << n << " " << x;
      }
  EXPECT_THROW(SingleScattering(1, 1), std::domain_error);
}

TEST(DiffusionWidth, FollowsItsNodesAndStaysPositive) {
  const DiffusionWidth equal(1, Illumination::normal);
  // Near the formula that Christensen & Burley fitted to their own simulations for equal indices.
  for (const double a : {0.2, 0.4, 0.6, 0.75})
    EXPECT_NEAR(equal.scale(a) / published_diffusion_scale(a, Illumination::normal), 1, 0.1) << a;
  const DiffusionWidth glass(1.5, Illumination::diffuse);
  for (double a = 0; a <= 1; a += 0.1) EXPECT_GT(glass.scale(a), 0.3);
  EXPECT_THROW(DiffusionWidth(0, Illumination::normal), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
