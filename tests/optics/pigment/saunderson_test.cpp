// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/saunderson.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>

#include "aureole/optics/stack/plane_stack.h"

namespace aureole::pigment {
namespace {

TEST(Saunderson, SmoothInterfaces) {
  const Surface s = smooth_surface(1.5, Geometry::diffuse_diffuse, Specular::included);
  EXPECT_NEAR(s.seen, 0.0918, 5e-5);
  EXPECT_NEAR(s.k2, 0.5963, 5e-5);
  EXPECT_NEAR(s.through, (1 - s.seen) * (1 - s.k2), 1e-15);
  // A white layer that loses nothing stays white, whichever way it is seen.
  EXPECT_NEAR(outer_reflectance(s, 1), 1, 1e-12);
  const Surface sphere = smooth_surface(1.5, Geometry::diffuse_8, Specular::included);
  EXPECT_NEAR(sphere.seen, 0.04, 1e-4);
  EXPECT_NEAR(outer_reflectance(sphere, 1), 1, 1e-12);
  EXPECT_EQ(smooth_surface(1.5, Geometry::diffuse_8, Specular::excluded).seen, 0);
  EXPECT_EQ(smooth_surface(1.5, Geometry::angle_45_0, Specular::included).seen, 0);
  // No interface.
  EXPECT_EQ(outer_reflectance(smooth_surface(1, Geometry::diffuse_diffuse, Specular::included), 0.3), 0.3);
}

/// Light that is followed from one reflection to the next: all orders, added one by one.
LayerTransfer bounced(double k1, double k2, LayerTransfer layer) {
  LayerTransfer total{k1, 0};
  double up = 0, down = 1 - k1;  // in the binder at the upper interface, leaving it and arriving
  double lower_up = 0;           // leaving the lower interface upwards
  for (int i = 0; i < 4000; ++i) {
    const double at_top = layer.reflectance * down + layer.transmittance * lower_up;
    const double at_bottom = layer.transmittance * down + layer.reflectance * lower_up;
    total.reflectance += (1 - k2) * at_top;
    total.transmittance += (1 - k2) * at_bottom;
    up = k2 * at_top;
    down = up;
    lower_up = k2 * at_bottom;
  }
  return total;
}

TEST(Saunderson, ReflectanceAndTransmittance) {
  const double k1 = 0.0918, k2 = 0.5963;
  const Surface s = saunderson_surface(k1, k2, Specular::included);
  for (const LayerTransfer inner :
       {LayerTransfer{0.4, 0.3}, {0, 1}, {0, 0.2}, {0.9, 0}, {0.35, 0.65}, {0.1, 0.05}}) {
    const LayerTransfer outer = outer_transfer(s, inner), expected = bounced(k1, k2, inner);
    EXPECT_NEAR(outer.reflectance, expected.reflectance, 1e-12);
    EXPECT_NEAR(outer.transmittance, expected.transmittance, 1e-12);
    const LayerTransfer back = inner_transfer(s, outer);
    EXPECT_NEAR(back.reflectance, inner.reflectance, 1e-12);
    EXPECT_NEAR(back.transmittance, inner.transmittance, 1e-12);
    if (inner.transmittance == 0) {
      EXPECT_NEAR(outer_reflectance(s, inner.reflectance), outer.reflectance, 1e-15);
    }
  }
  // The form in print: N = (1 - k2 R)^2 - (k2 T)^2.
  const double r = 0.4, t = 0.3, n = std::pow(1 - k2 * r, 2) - std::pow(k2 * t, 2);
  const LayerTransfer outer = outer_transfer(s, {r, t});
  EXPECT_NEAR(outer.reflectance, k1 + (1 - k1) * (1 - k2) * (r - k2 * (r * r - t * t)) / n, 1e-14);
  EXPECT_NEAR(outer.transmittance, (1 - k1) * (1 - k2) * t / n, 1e-14);
}

/// A layer of this index between media of index `outside`, in diffuse light: R and T by 32 streams. Thickness
/// counts in 1/(sigma_s (1 - g)).
LayerTransfer by_streams(double albedo, double thickness, double g, double index, double outside) {
  optics::StackDescription stack;
  const double s = 1 / (1 - g);
  stack.layers = {
      {s * (1 - albedo) / albedo, s, thickness, optics::LegendrePhase::henyey_greenstein(g), index}};
  stack.index_above = stack.index_below = outside;
  const auto f = optics::PlaneStack(stack, {32}).fluxes(optics::StackLight::diffuse());
  return {f.reflectance, f.transmittance};
}

// Saunderson takes the light at the interfaces for diffuse, from within as from outside. So it is where a layer is
// thick and white; in thin ones light keeps the directions that the interface gave it, of which less is turned back.
TEST(Saunderson, AgainstStreamsWithTheSameInterfaces) {
  struct Known {
    double albedo, thickness, g, error_r, error_t;
  };
  // The errors of Saunderson's form are part of the test, so that faults beside them show. docs/pigments.md has them.
  const Known known[] = {
      {1, 0.1, 0, 0.24935, -0.24935},   {1, 1, 0, 0.10715, -0.10715},     {1, 10, 0, 0.01025, -0.01025},
      {1, 100, 0, 0.0002, -0.0002},     {1, 0.1, 0.8, 0.22314, -0.22314}, {1, 1, 0.8, 0.06689, -0.06689},
      {1, 10, 0.8, 0.00975, -0.00975},  {1, 100, 0.8, 0.0002, -0.0002},   {0.99, 0.1, 0, 0.24904, -0.24916},
      {0.99, 1, 0, 0.10581, -0.10645},  {0.99, 10, 0, 0.01513, -0.00811}, {0.99, 100, 0, 0.01343, 0},
      {0.99, 100, 0.8, 0.03084, 0},     {0.9, 0.1, 0, 0.24169, -0.25141}, {0.9, 1, 0, 0.08176, -0.11112},
      {0.9, 10, 0, 0.02901, -0.00044},  {0.9, 100, 0, 0.02901, 0},        {0.9, 100, 0.8, 0.03346, 0},
      {0.5, 0.1, 0, 0.15365, -0.29654}, {0.5, 1, 0, 0.01663, -0.06615},   {0.5, 10, 0, 0.01453, 0},
      {0.5, 100, 0, 0.01453, 0},        {0.5, 100, 0.8, 0.00861, 0}};
  const double index = 1.5;
  const Surface surface = smooth_surface(index, Geometry::diffuse_diffuse, Specular::included);
  std::printf("%7s %9s %4s %10s %10s %10s %10s\n", "albedo", "thickness", "g", "R", "error", "T", "error");
  for (const Known& k : known) {
    const LayerTransfer all = by_streams(k.albedo, k.thickness, k.g, index, 1);
    const LayerTransfer outer = outer_transfer(surface, by_streams(k.albedo, k.thickness, k.g, index, index));
    const double r = outer.reflectance - all.reflectance, t = outer.transmittance - all.transmittance;
    std::printf("%7g %9g %4g %10.5f %+10.5f %10.5f %+10.5f\n", k.albedo, k.thickness, k.g, all.reflectance, r,
                all.transmittance, t);
    EXPECT_NEAR(r, k.error_r, std::max(5e-5, 0.005 * k.error_r)) << k.albedo << " " << k.thickness;
    EXPECT_NEAR(t, k.error_t, std::max(5e-5, 0.005 * -k.error_t)) << k.albedo << " " << k.thickness;
  }
}

// Over a Lambertian surface at no distance all light within is diffuse, and Saunderson's form is exact.
TEST(Saunderson, OfALambertianSurfaceIsExact) {
  for (const double index : {1.33, 1.5, 2.0})
    for (const double rho : {0.0, 0.2, 0.9, 1.0})
      for (const double alpha : {0.0, 0.3}) {
        optics::StackDescription stack;
        stack.layers = {{0, 0, 1e-9, optics::LegendrePhase::isotropic(), index}};
        if (alpha > 0) stack.layers[0].top = {optics::InterfaceKind::ggx, alpha};
        stack.substrate = rho;
        const double all = optics::PlaneStack(stack, {64}).fluxes(optics::StackLight::diffuse()).reflectance;
        const Surface surface = alpha > 0
                                    ? rough_surface(index, alpha, Specular::included)
                                    : smooth_surface(index, Geometry::diffuse_diffuse, Specular::included);
        // Streams give light that facets lose at the first meeting to both sides, Saunderson's k1 to the inside only.
        EXPECT_NEAR(outer_reflectance(surface, rho), all, alpha > 0 ? 5e-3 : 1e-12);
      }
}

TEST(Saunderson, BothWays) {
  for (const Surface& s :
       {saunderson_surface(0.04, 0.6, Specular::included), saunderson_surface(0.04, 0.6, Specular::excluded),
        smooth_surface(1.49, Geometry::angle_45_0, Specular::excluded), Surface{}})
    for (int i = 0; i <= 20; ++i)
      EXPECT_NEAR(inner_reflectance(s, outer_reflectance(s, i / 20.0)), i / 20.0, 1e-13);
}

TEST(Saunderson, RoughInterfaces) {
  // Against random facets: a direction by its cosine, a facet, its reflection, Walter et al. 2007 (20).
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  const double index = 1.5;
  const auto masking = [](double mu, double alpha) {
    return 2 / (1 + std::sqrt(1 + alpha * alpha * (1 / (mu * mu) - 1)));
  };
  for (const double alpha : {0.1, 0.3, 0.7}) {
    constexpr int kCount = 400000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kCount; ++i) {
      const double mu = std::sqrt(uniform(random)), sine = std::sqrt(1 - mu * mu);
      const double u = uniform(random), phi = 2 * M_PI * uniform(random);
      const double theta = std::atan(alpha * std::sqrt(u / (1 - u)));
      const double facing = mu * std::cos(theta) + sine * std::sin(theta) * std::cos(phi);
      const double mu_out = 2 * facing * std::cos(theta) - mu;
      if (facing <= 0 || mu_out <= 0) continue;
      const double refracted = std::sqrt(index * index - 1 + facing * facing);
      const double rs = (facing - refracted) / (facing + refracted);
      const double rp = (index * index * facing - refracted) / (index * index * facing + refracted);
      const double value = 0.5 * (rs * rs + rp * rp) * masking(mu, alpha) * masking(mu_out, alpha) * facing /
                           (mu * std::cos(theta));
      sum += value, squares += value * value;
    }
    const double mean = sum / kCount, error = std::sqrt((squares / kCount - mean * mean) / kCount);
    const double k1 = rough_diffuse_reflectance(index, alpha);
    EXPECT_NEAR(k1, mean, 4 * error + 2e-4) << alpha;
    const Surface s = rough_surface(index, alpha, Specular::included);
    EXPECT_EQ(s.seen, k1);
    EXPECT_NEAR(outer_reflectance(s, 1), 1, 1e-12);  // nothing is lost
  }
  EXPECT_NEAR(rough_diffuse_reflectance(index, 0.002), rough_diffuse_reflectance(index, 0), 5e-4);
}

TEST(Saunderson, ImpossibleDataAreNamed) {
  const Surface s = saunderson_surface(0.04, 0.6, Specular::included);
  EXPECT_THROW(inner_reflectance(s, 0.03), std::domain_error);
  EXPECT_THROW(inner_reflectance(s, 1.01), std::domain_error);
  EXPECT_THROW(inner_transfer(s, {0.9, 0.4}), std::domain_error);
  EXPECT_THROW(outer_reflectance(s, -0.1), std::domain_error);
  EXPECT_THROW(saunderson_surface(1, 0.5, Specular::included), std::domain_error);
  EXPECT_THROW(smooth_surface(0.9, Geometry::diffuse_8, Specular::included), std::domain_error);
  EXPECT_THROW(rough_surface(1.5, -1, Specular::included), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment
