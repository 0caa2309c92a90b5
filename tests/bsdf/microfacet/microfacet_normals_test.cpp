// SPDX-License-Identifier: Apache-2.0
// The distributions of microfacet normals against their definitions.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/instrument/check/direction_bins.h"
#include "aureole/math/significance.h"

namespace aureole::testing {
namespace {

Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

struct Shape {
  NormalDistribution type;
  float u, v;
};
constexpr Shape kShapes[] = {
    {NormalDistribution::beckmann, 0.05f, 0.05f}, {NormalDistribution::beckmann, 0.3f, 0.3f},
    {NormalDistribution::beckmann, 1.5f, 1.5f},   {NormalDistribution::beckmann, 0.1f, 0.6f},
    {NormalDistribution::ggx, 0.05f, 0.05f},      {NormalDistribution::ggx, 0.3f, 0.3f},
    {NormalDistribution::ggx, 1.5f, 1.5f},        {NormalDistribution::ggx, 0.6f, 0.1f}};

/// Integrals of f(m) D(m) over the hemisphere: in the slope over alpha, whose density is smooth, by
/// midpoints.
template <class F>
double integrate(const Microfacets& d, F&& f) {
  constexpr int kRadii = 2000, kAngles = 256;
  double sum = 0;
  for (int i = 0; i < kRadii; ++i) {
    const double t = (i + 0.5) / kRadii, r = t / (1 - t), dr = 1 / ((1 - t) * (1 - t)) / kRadii;
    for (int j = 0; j < kAngles; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / kAngles;
      const double x = r * d.alpha_u() * std::cos(phi), y = r * d.alpha_v() * std::sin(phi);
      const double z = 1 / std::sqrt(1 + x * x + y * y);
      const Vec3 m{float(-x * z), float(-y * z), float(z)};
      // dm = cos^3 dx dy.
      const double solid_angle = z * z * z * d.alpha_u() * d.alpha_v() * r * dr * 2 * M_PI / kAngles;
      sum += f(m) * double(d.density(m)) * solid_angle;
    }
  }
  return sum;
}

TEST(Microfacets, NormalsAreNormalised) {
  for (const Shape& s : kShapes)
    EXPECT_NEAR(integrate({s.type, s.u, s.v}, [](const Vec3& m) { return double(m.z); }), 1, 2e-4)
        << s.u << " " << s.v;
}

/// The facets that wi sees cover the projected area of the surface: the weak white furnace.
TEST(Microfacets, MaskingKeepsTheProjectedArea) {
  for (const Shape& s : kShapes)
    for (const double theta : {0.0, 0.5, 1.0, 1.4, 1.55}) {
      const Microfacets d(s.type, s.u, s.v);
      const Vec3 v = direction(theta, 0.7);
      const double area = integrate(d, [&](const Vec3& m) { return std::max(double(dot(v, m)), 0.0); });
      EXPECT_NEAR(d.masking(v) * area / v.z, 1, 1e-3) << s.u << " " << s.v << " " << theta;
    }
}

TEST(Microfacets, SpectraAgreeWithNumbers) {
  for (const Shape& s : kShapes) {
    const Microfacets d(s.type, s.u, s.v);
    for (float theta = 0; theta < 1.57f; theta += 0.01f) {
      const Vec3 m = direction(theta, 2 * theta);
      const float one = d.density(m), all = d.density(Spectrum(m.x), Spectrum(m.y), Spectrum(m.z))[0];
      EXPECT_NEAR(all, one, 2e-6f * one + 1e-30f);
    }
    EXPECT_EQ(d.density(Spectrum(1.f), Spectrum(0.f), Spectrum(0.f))[0], 0);
  }
  for (const float x : {0.f, -1e-6f, -0.3f, -1.f, -10.f, -50.f, -86.f})
    EXPECT_NEAR(exp_of_negative(x)[0] / std::exp(x), 1, 3e-7) << x;
  EXPECT_EQ(exp_of_negative(-100.f)[0], 0);
  EXPECT_EQ(exp_of_negative(-kInfinity)[0], 0);
}

/// Both samplers of normals, by chi-square against their densities.
TEST(Microfacets, NormalsFollowTheirDensity) {
  constexpr std::size_t kSamples = 200000;
  const double level = sidak_level(0.01, std::size(kShapes) * 5);
  SeededRandom random(7);
  for (const Shape& s : kShapes)
    for (const double theta : {0.0, 0.6, 1.3, 1.56, -1.0}) {
      const Microfacets d(s.type, s.u, s.v);
      const bool all = theta < 0;
      const Vec3 wi = direction(std::abs(theta), 2.2);
      const auto draw = [&] {
        return all ? d.sample_all(random.next2()) : d.sample_visible(wi, random.next2());
      };
      DirectionBins::Options options;
      options.focus = {{0, 0, 1}};  // quadrature may miss a lobe in the corner of a large bin
      for (int i = 0; i < 20000; ++i) options.pilot.push_back(draw());
      const DirectionBins bins(
          [&](const Vec3& m) {
            const double seen = all ? m.z : std::max(dot(wi, m), 0.f) * d.masking_over_cos(wi);
            return DirectionBins::Value{m.z > 0 ? d.density(m) * seen : 0, {}};
          },
          options);
      EXPECT_NEAR(bins.mass(), 1, 2e-3);
      std::vector<std::size_t> counts(bins.bins().size());
      for (std::size_t i = 0; i < kSamples; ++i) ++counts[bins.find(draw())];
      const ChiSquareResult r = chi_square_test(bins.masses(), counts, kSamples, 100);
      EXPECT_GT(r.p_value, level) << "alpha " << s.u << " " << s.v << ", theta " << theta << ", chi-square "
                                  << r.statistic << " in " << r.bins;
    }
}

}  // namespace
}  // namespace aureole::testing
