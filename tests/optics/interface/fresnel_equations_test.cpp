// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/interface/fresnel_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;

double refracted_cosine(double cos_i, double n_i, double n_t) {
  const double sin_t = n_i / n_t * std::sqrt(1 - cos_i * cos_i);
  return std::sqrt(1 - sin_t * sin_t);
}

/// Walsh's closed form of the external diffuse reflectance, m > 1 (Duntley, "The optical properties of
/// diffusing materials", 1942, JOSA 32, 61).
double walsh(double m) {
  const double m2 = m * m, m4 = m2 * m2;
  return 0.5 + (m - 1) * (3 * m + 1) / (6 * (m + 1) * (m + 1)) +
         m2 * (m2 - 1) * (m2 - 1) / std::pow(m2 + 1, 3) * std::log((m - 1) / (m + 1)) -
         2 * m * m2 * (m2 + 2 * m - 1) / ((m2 + 1) * (m4 - 1)) +
         8 * m4 * (m4 + 1) / ((m2 + 1) * (m4 - 1) * (m4 - 1)) * std::log(m);
}

TEST(Fresnel, NormalIncidenceAndSigns) {
  const FresnelAmplitudes a = fresnel_amplitudes(1, 1, 1.5);
  EXPECT_NEAR(std::abs(a.r_s - Complex(-0.2)), 0, 1e-15);
  EXPECT_NEAR(std::abs(a.r_p - Complex(0.2)), 0, 1e-15);
  EXPECT_NEAR(std::abs(a.t_s - Complex(0.8)), 0, 1e-15);
  EXPECT_NEAR(std::abs(a.t_p - Complex(0.8)), 0, 1e-15);
  EXPECT_NEAR(fresnel_reflectance(1, 1, 1.5), 0.04, 1e-15);
}

TEST(Fresnel, SinesAndTangentsForm) {
  // Fresnel's own form: r_s = -sin(i-t)/sin(i+t), r_p = tan(i-t)/tan(i+t).
  for (double theta = 0.05; theta < 1.55; theta += 0.1) {
    const double t = std::asin(std::sin(theta) / 1.33);
    const FresnelAmplitudes a = fresnel_amplitudes(std::cos(theta), 1, 1.33);
    EXPECT_NEAR(a.r_s.real(), -std::sin(theta - t) / std::sin(theta + t), 1e-13);
    EXPECT_NEAR(a.r_p.real(), std::tan(theta - t) / std::tan(theta + t), 1e-13);
    EXPECT_NEAR(a.cos_t.real(), std::cos(t), 1e-13);
    EXPECT_NEAR(fresnel_reflectance(std::cos(theta), 1, 1.33), (std::norm(a.r_s) + std::norm(a.r_p)) / 2,
                1e-14);
  }
}

TEST(Fresnel, BrewsterAngle) {
  const double cos_b = std::cos(std::atan(1.5));
  const FresnelAmplitudes a = fresnel_amplitudes(cos_b, 1, 1.5);
  EXPECT_NEAR(std::abs(a.r_p), 0, 1e-15);
  EXPECT_NEAR(a.r_s.real(), -(1.5 * 1.5 - 1) / (1.5 * 1.5 + 1), 1e-15);
}

TEST(Fresnel, EnergyAndStokesReciprocity) {
  for (double n_t : {1.0001, 1.33, 2.4, 0.7})
    for (double cos_i : {1.0, 0.9, 0.75}) {
      const double cos_t = refracted_cosine(cos_i, 1, n_t);
      const FresnelAmplitudes there = fresnel_amplitudes(cos_i, 1, n_t),
                              back = fresnel_amplitudes(cos_t, n_t, 1);
      const double flux = n_t * cos_t / cos_i;
      EXPECT_NEAR(std::norm(there.r_s) + flux * std::norm(there.t_s), 1, 1e-13);
      EXPECT_NEAR(std::norm(there.r_p) + flux * std::norm(there.t_p), 1, 1e-13);
      // Stokes: t/(n cos) is the same both ways, r changes sign, r^2 + t t' = 1.
      EXPECT_NEAR(std::abs(there.t_s / cos_i - back.t_s / (n_t * cos_t)), 0, 1e-13);
      EXPECT_NEAR(std::abs(there.t_p / cos_i - back.t_p / (n_t * cos_t)), 0, 1e-13);
      EXPECT_NEAR(std::abs(there.r_s + back.r_s), 0, 1e-13);
      EXPECT_NEAR(std::abs(there.r_p + back.r_p), 0, 1e-13);
      EXPECT_NEAR(std::abs(there.r_p * there.r_p + there.t_p * back.t_p - 1.0), 0, 1e-13);
      EXPECT_NEAR(fresnel_reflectance(cos_i, 1, n_t), fresnel_reflectance(cos_t, n_t, 1), 1e-13);
    }
}

TEST(Fresnel, AbsorbingEnergyBalance) {
  // The power that is not reflected crosses the interface and is absorbed below it.
  const Complex n(0.8, 2.1);
  for (double cos_i : {1.0, 0.6, 0.1}) {
    const FresnelAmplitudes a = fresnel_amplitudes(cos_i, 1.33, n);
    const double into_s = (n * a.cos_t).real() / (1.33 * cos_i) * std::norm(a.t_s);
    const double into_p = (n * std::conj(a.cos_t)).real() / (1.33 * cos_i) * std::norm(a.t_p);
    EXPECT_NEAR(std::norm(a.r_s) + into_s, 1, 1e-13);
    EXPECT_NEAR(std::norm(a.r_p) + into_p, 1, 1e-13);
    EXPECT_GT((n * a.cos_t).imag(), 0);
  }
}

TEST(Fresnel, TotalInternalReflectionPhases) {
  const double n = 1 / 1.5;
  for (double theta : {0.75, 1.0, 1.3, 1.55}) {
    const double kappa = std::sqrt(std::sin(theta) * std::sin(theta) - n * n);
    const FresnelAmplitudes a = fresnel_amplitudes(std::cos(theta), 1.5, 1);
    EXPECT_NEAR(std::abs(a.r_s), 1, 1e-14);
    EXPECT_NEAR(std::abs(a.r_p), 1, 1e-14);
    // Half the phases (Born & Wolf 1999, section 1.5.4), for exp(-i omega t).
    EXPECT_NEAR(std::tan(std::arg(a.r_s) / 2), -kappa / std::cos(theta), 1e-10);
    EXPECT_NEAR(std::tan(std::arg(a.r_p) / 2), -kappa / (n * n * std::cos(theta)), 1e-9);
    EXPECT_NEAR(std::abs(a.cos_t - Complex(0, kappa / n)), 0, 1e-13);
    EXPECT_EQ(fresnel_reflectance(std::cos(theta), 1.5, 1), 1);
  }
}

TEST(Fresnel, Conductors) {
  // Gold near 550 nm, n = 0.43 + 2.455 i (Johnson & Christy 1972), by the formula for normal incidence.
  const double eta = 0.43, k = 2.455;
  const double expected = ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
  EXPECT_NEAR(fresnel_reflectance_conductor(1, 1, {eta, k}), expected, 1e-14);
  EXPECT_NEAR(expected, 0.787, 1e-3);
  EXPECT_NEAR(fresnel_reflectance_conductor(0, 1, {eta, k}), 1, 1e-14);
  for (double cos_i : {0.05, 0.3, 0.5, 0.8, 1.0}) {
    EXPECT_NEAR(fresnel_reflectance_conductor(cos_i, 1, {1.5, 0}), fresnel_reflectance(cos_i, 1, 1.5), 1e-14);
    // Real form of the squared moduli (Born & Wolf 1999, section 14.2, u = Re, v = Im of n cos_t).
    const double sin2 = 1 - cos_i * cos_i, d = eta * eta - k * k - sin2;
    const double modulus = std::sqrt(d * d + 4 * eta * eta * k * k);
    const double u = std::sqrt((modulus + d) / 2), v2 = (modulus - d) / 2;
    const double r_s = ((cos_i - u) * (cos_i - u) + v2) / ((cos_i + u) * (cos_i + u) + v2);
    const double st = sin2 / cos_i;
    const double r_p = r_s * ((u - st) * (u - st) + v2) / ((u + st) * (u + st) + v2);
    EXPECT_NEAR(fresnel_reflectance_conductor(cos_i, 1, {eta, k}), (r_s + r_p) / 2, 1e-13);
  }
}

TEST(Fresnel, ThinSlabIsTheSumOfItsInterreflections) {
  for (double cos_i : {0.0, 0.2, 0.7, 1.0}) {
    const double r = fresnel_reflectance(cos_i, 1, 1.5);
    double sum = r, inside = (1 - r) * (1 - r) * r;
    for (int bounce = 0; bounce < 4000; ++bounce, inside *= r * r) sum += inside;
    EXPECT_NEAR(thin_slab_reflectance(cos_i, 1, 1.5), sum, 1e-12);
  }
  EXPECT_EQ(thin_slab_reflectance(0.1, 1.5, 1), 1);
}

TEST(Fresnel, DiffuseReflectance) {
  EXPECT_NEAR(fresnel_diffuse_reflectance(1.5), 0.0918, 5e-5);
  EXPECT_NEAR(fresnel_diffuse_reflectance(1 / 1.5), 0.5963, 5e-5);
  for (double m : {1.1, 1.33, 1.5, 2.0, 4.0}) {
    EXPECT_NEAR(fresnel_diffuse_reflectance(m), walsh(m), 1e-10) << m;
    double sum = 0;  // the internal reflectance by the midpoint rule, in spite of the kink
    const int cells = 200000;
    for (int i = 0; i < cells; ++i) {
      const double mu = (i + 0.5) / cells;
      sum += 2 * mu * fresnel_reflectance(mu, m, 1) / cells;
    }
    EXPECT_NEAR(fresnel_diffuse_reflectance(1 / m), sum, 1e-6) << m;
  }
  EXPECT_EQ(fresnel_diffuse_reflectance(1), 0);
  EXPECT_GT(fresnel_diffuse_reflectance(1 + 1e-6), 0);
  EXPECT_LT(fresnel_diffuse_reflectance(1 + 1e-6), 1e-5);
}

TEST(Fresnel, LimitsAndErrors) {
  EXPECT_EQ(fresnel_reflectance(0, 1, 1.5), 1);
  EXPECT_EQ(fresnel_reflectance(0, 1, 1), 0);
  EXPECT_EQ(fresnel_amplitudes(0, 1.5, 1.5).t_p, 1.0);
  EXPECT_EQ(fresnel_reflectance(1 + 1e-7, 1, 1.5), fresnel_reflectance(1, 1, 1.5));
  EXPECT_THROW(fresnel_reflectance(1.1, 1, 1.5), std::domain_error);
  EXPECT_THROW(fresnel_reflectance(-0.1, 1, 1.5), std::domain_error);
  EXPECT_THROW(fresnel_reflectance(std::nan(""), 1, 1.5), std::domain_error);
  EXPECT_THROW(fresnel_reflectance(0.5, 0, 1.5), std::domain_error);
  EXPECT_THROW(fresnel_reflectance(0.5, 1, -1.5), std::domain_error);
  EXPECT_THROW(fresnel_reflectance_conductor(0.5, 1, {0.4, -2}), std::domain_error);
  EXPECT_THROW(fresnel_diffuse_reflectance(std::numeric_limits<double>::infinity()), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
