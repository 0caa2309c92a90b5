// SPDX-License-Identifier: Apache-2.0
// `slab_powers` against the sum over partial waves, limits in closed form, and conservation of energy.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <stdexcept>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {
namespace {

using C = std::complex<double>;

/// Adds the waves that leave the slab after 0, 1, 2, ... reflections within it, with Fresnel's coefficients written by
/// sines and cosines of the (complex) angle within.
SlabPowers sum_of_waves(double cos_i, C n, double thickness) {
  const C sin_t = std::sqrt(1 - cos_i * cos_i) / n;
  C cos_t = std::sqrt(1.0 - sin_t * sin_t);
  if ((n * cos_t).imag() < 0) cos_t = -cos_t;
  const C way = std::exp(C(0, 2 * std::numbers::pi * thickness) * n * cos_t);
  SlabPowers mean;
  for (const bool s : {true, false}) {
    const C a = s ? cos_i : n * cos_i, b = s ? n * cos_t : cos_t;
    const C r = (a - b) / (a + b);                        // from outside
    const C through = 4.0 * a * b / ((a + b) * (a + b));  // into the slab and out of it
    C reflected = r, transmitted = 0, wave = through * way;
    for (int i = 0; i < 4000; ++i) {
      transmitted += wave;
      wave *= -r * way;
      reflected += wave;
      wave *= -r * way;
    }
    mean.reflected += 0.5 * std::norm(reflected), mean.transmitted += 0.5 * std::norm(transmitted);
  }
  return mean;
}

TEST(Slab, IsTheSumOfItsWaves) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 300; ++i) {
    const double cos_i = 0.02 + 0.98 * u(random), thickness = 5 * u(random) + 1e-3;
    const C n(0.6 + 3 * u(random), i % 3 == 0 ? 0 : u(random));
    const SlabPowers slab = slab_powers(cos_i, 1, n, thickness), sum = sum_of_waves(cos_i, n, thickness);
    EXPECT_NEAR(slab.reflected, sum.reflected, 1e-10) << cos_i << n << thickness;
    EXPECT_NEAR(slab.transmitted, sum.transmitted, 1e-10) << cos_i << n << thickness;
    const double all = slab.reflected + slab.transmitted;
    if (n.imag() == 0)
      EXPECT_NEAR(all, 1, 1e-12);
    else
      EXPECT_LT(all, 1);
  }
}

// Only the ratio of the indices counts, and the wavelength around the slab.
TEST(Slab, InOtherMatter) {
  for (const double n_ext : {0.8, 1.33, 2.}) {
    const SlabPowers a = slab_powers(0.6, n_ext, C(1.7, 0.05), 0.9),
                     b = slab_powers(0.6, 1, C(1.7, 0.05) / n_ext, 0.9 * n_ext);
    EXPECT_NEAR(a.reflected, b.reflected, 1e-12);
    EXPECT_NEAR(a.transmitted, b.transmitted, 1e-12);
  }
  // At the critical angle of a thin gap nearly all light passes.
  const double critical = std::sqrt(1 - 0.64);
  EXPECT_NEAR(slab_powers(critical, 1.25, 1, 0.02).transmitted,
              slab_powers(critical + 1e-5, 1.25, 1, 0.02).transmitted, 1e-3);
}

TEST(Slab, Limits) {
  // Of half a wavelength: no reflection. Of a quarter: ((n^2 - 1)/(n^2 + 1))^2.
  EXPECT_NEAR(slab_powers(1, 1, 2, 0.25).reflected, 0, 1e-12);
  EXPECT_NEAR(slab_powers(1, 1, 2, 0.125).reflected, std::pow(3. / 5, 2), 1e-12);
  // A slab of the matter around it, of any thickness.
  EXPECT_NEAR(slab_powers(0.3, 1.5, 1.5, 7.3).transmitted, 1, 1e-12);
  // Thin: nothing is reflected. Thick and absorbing: one face remains.
  EXPECT_NEAR(slab_powers(0.7, 1, C(2, 1), 1e-9).transmitted, 1, 1e-6);
  EXPECT_NEAR(slab_powers(0.7, 1, C(2, 1), 1e3).reflected, fresnel_reflectance_conductor(0.7, 1, C(2, 1)),
              1e-12);
  EXPECT_EQ(slab_powers(0.7, 1, C(2, 1), 1e3).transmitted, 0);
  // Grazing incidence.
  EXPECT_NEAR(slab_powers(0, 1, 1.5, 0.4).reflected, 1, 1e-12);
  // Total reflection at both faces of an air gap in glass, less what tunnels (frustrated): a thin gap lets light through.
  EXPECT_GT(slab_powers(0.5, 1.5, 1, 0.02).transmitted, 0.9);
  EXPECT_LT(slab_powers(0.5, 1.5, 1, 2).transmitted, 1e-6);
  // The mean over fringes of a thick slab without loss is that of powers, for each polarisation: at normal incidence
  // the closed form 2R/(1 + R).
  double mean = 0;
  for (int i = 0; i < 1000; ++i) mean += slab_powers(1, 1, 1.5, 50 + i / 3000.).reflected / 1000;
  EXPECT_NEAR(mean, thin_slab_reflectance(1, 1, 1.5), 1e-6);
}

TEST(Slab, BadInputIsAnError) {
  for (const double thickness : {0., -1., double(NAN), double(INFINITY)})
    EXPECT_THROW(slab_powers(1, 1, 1.5, thickness), std::domain_error) << thickness;
  EXPECT_THROW(slab_powers(1.1, 1, 1.5, 1), std::domain_error);
  EXPECT_THROW(slab_powers(1, 1, C(1.5, -1), 1), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
