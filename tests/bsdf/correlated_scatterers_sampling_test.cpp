// SPDX-License-Identifier: Apache-2.0
// Samples of the layer of correlated scatterers against their density, and its strategies against one another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bsdf/layer_cases.h"

namespace aureole {
namespace {

using namespace testing::layer_cases;
constexpr double kPi = std::numbers::pi;
using Mode = TransportMode;

/// Chi-square of samples against the density over bins of (u, azimuth of q) on either side.
void check_distribution(const LayerCase& s, double degrees, unsigned seed) {
  const auto bsdf = s.build();
  const Vec3 wi = direction(degrees, 15);
  const Context c;
  const double phase = 2 * kPi / (kLambdas[0] * 1e-9) * s.a(), n_i = s.index(wi.z);
  const int rings = 40, azimuths = 8, bins = 2 * rings * azimuths, samples = test::effort(60000, 200000);
  const double u_end = phase * (1.5 + n_i);
  // Narrow rings in the middle and wide ones outside.
  const auto ring_of = [&](double u) { return std::min(rings - 1, int(rings * std::sqrt(u / u_end))); };
  const auto bin_of = [&](const Vec3& wo) {
    const double n = s.index(wo.z), x = n * wo.x + n_i * wi.x, y = n * wo.y + n_i * wi.y;
    double f = std::atan2(y, x) / (2 * kPi);
    f -= std::floor(f);
    return ((wo.z > 0 ? rings : 0) + ring_of(phase * std::hypot(x, y))) * azimuths +
           std::min(int(f * azimuths), azimuths - 1);
  };
  std::vector<double> expected(bins, 0.0), observed(bins, 0.0);
  double mass = 0;
  const int fine = std::max(1600, int(u_end * 40)), around = 160;
  for (int i = 0; i < fine; ++i) {
    const double u = (i + 0.5) * u_end / fine, area = u * (u_end / fine) * 2 * kPi / around / (phase * phase);
    for (int m = 0; m < around; ++m) {
      const double f = 2 * kPi * (m + 0.5) / around;
      const double x = u / phase * std::cos(f) - n_i * wi.x, y = u / phase * std::sin(f) - n_i * wi.y;
      for (double side : {1., -1.}) {
        const double n = s.index(side), c2 = 1 - (x * x + y * y) / (n * n);
        if (c2 <= 1e-9) continue;
        const Vec3 wo{float(x / n), float(y / n), float(side * std::sqrt(c2))};
        const double p = bsdf->pdf(wi, wo, c.ctx)[0] * area / (n * n * std::sqrt(c2));
        expected[bin_of(wo)] += p;
        mass += p;
      }
    }
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  int kept = 0;
  const auto below_one = [&] { return std::min(float(uniform(random)), 0x1.fffffep-1f); };
  for (int i = 0; i < samples; ++i) {
    const auto x = bsdf->sample(wi, below_one(), {below_one(), below_one()}, c.ctx);
    if (!x || x->is_delta()) continue;
    ++kept;
    ++observed[bin_of(x->wo)];
    const BsdfEval e = bsdf->eval_pdf(wi, x->wo, c.ctx);
    for (int j = 0; j < kWavelengths; ++j) {
      ASSERT_EQ(e.value[j], x->value[j]);
      ASSERT_EQ(e.pdf[j], x->pdf[j]);
    }
  }
  EXPECT_NEAR(double(kept) / samples, mass, 5 * std::sqrt(mass / samples) + 2e-3) << s.substrate << degrees;
  double chi2 = 0, pooled_expected = 0, pooled_observed = 0;
  int freedom = 0;
  const auto add = [&](double e, double o) {
    // The quadrature's own error is some 0.5 % of a bin.
    chi2 += (o - e) * (o - e) / (e + 2.5e-5 * e * e);
    ++freedom;
  };
  for (int i = 0; i < bins; ++i) {
    const double e = expected[i] * samples;
    if (e < 20)
      pooled_expected += e, pooled_observed += observed[i];
    else
      add(e, observed[i]);
  }
  if (pooled_expected > 20) add(pooled_expected, pooled_observed);
  // Wilson and Hilferty's approximation of the chi-square distribution, at five sigma.
  const double v = 2.0 / (9 * freedom), z = (std::cbrt(chi2 / freedom) - (1 - v)) / std::sqrt(v);
  EXPECT_LT(z, 5) << s.substrate << " " << s.extra << " " << degrees << ": chi2 " << chi2 << " for "
                  << freedom;
}

TEST(CorrelatedScatterers, SamplesFollowTheirDensity) {
  unsigned seed = 1;
  for (const char* extra : {"product", "factors"})
    for (const char* substrate : {"none", "thindielectric", "dielectric"})
      for (double degrees : {0., 70., 125., 155.}) {
        if (substrate != std::string("dielectric") && degrees > 90) continue;
        check_distribution({.substrate = substrate,
                            .radius = "1.6um",
                            .correlation_radius = "2um",
                            .extra = text("sampling", extra)},
                           degrees, seed++);
      }
}

TEST(CorrelatedScatterers, ProductSamplesHaveOneWeight) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  for (const char* substrate : {"none", "thindielectric", "dielectric"}) {
    const LayerCase s{.substrate = substrate};
    const auto bsdf = s.build();
    const Context c(Mode::importance);
    const Vec3 wi = direction(40);
    std::vector<double> weights;
    for (int i = 0; i < 4000; ++i) {
      const auto x = bsdf->sample(wi, 0.999f * uniform(random),
                                  {0.999f * uniform(random), 0.999f * uniform(random)}, c.ctx);
      if (!x || x->is_delta()) continue;
      weights.push_back(x->value[0] / x->pdf[0]);
    }
    // The intensity is cubic in its cells and the density linear: they differ where it bends much.
    std::sort(weights.begin(), weights.end());
    const std::size_t n = weights.size();
    ASSERT_GT(n, 800u);
    const double median = weights[n / 2];
    EXPECT_LT(weights[n * 9 / 10] / weights[n / 10], 1.001);
    EXPECT_LT(weights.back() / median, 1.05);
    std::printf("%-14s weights/median: %.6f (10 %%) %.6f (90 %%), largest %.4f\n", substrate,
                weights[n / 10] / median, weights[n * 9 / 10] / median, weights.back() / median);
  }
}

TEST(CorrelatedScatterers, FactorsGiveTheSameIntegrals) {
  // The power sent to each of several zones around the specular direction, estimated by either way of
  // sampling.
  const LayerCase product{.substrate = "thindielectric", .radius = "2um", .correlation_radius = "2um"};
  LayerCase factors = product;
  factors.extra = text("sampling", "factors");
  const Vec3 wi = direction(30);
  const Context c;
  const int samples = test::effort(100000, 400000), zones = 6;
  std::vector<double> mean[2], square[2];
  int which = 0;
  for (const LayerCase& s : {product, factors}) {
    const auto bsdf = s.build();
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform;
    const auto draw = [&] { return std::min(float(uniform(random)), 0x1.fffffep-1f); };
    mean[which].assign(zones, 0), square[which].assign(zones, 0);
    for (int i = 0; i < samples; ++i) {
      const auto x = bsdf->sample(wi, draw(), {draw(), draw()}, c.ctx);
      if (!x || x->is_delta()) continue;
      const double q = std::hypot(x->wo.x + wi.x, x->wo.y + wi.y);
      const int zone = (x->wo.z > 0 ? 3 : 0) + (q < 0.08 ? 0 : q < 0.2 ? 1 : 2);
      const double w = x->value[0] / x->pdf[0];
      mean[which][zone] += w / samples, square[which][zone] += w * w / samples;
    }
    ++which;
  }
  for (int z = 0; z < zones; ++z) {
    const double variance =
        (square[0][z] - mean[0][z] * mean[0][z] + square[1][z] - mean[1][z] * mean[1][z]) / samples;
    EXPECT_NEAR(mean[0][z], mean[1][z], 5 * std::sqrt(variance)) << z;
    EXPECT_GT(mean[0][z], 0);
  }
}

}  // namespace
}  // namespace aureole
