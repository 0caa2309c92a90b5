// SPDX-License-Identifier: Apache-2.0
// Rules for every registered BSSRDF, over the examples of its documentation: the density of distances integrates to one
// over the plane, samples follow it, no light is gained, and nothing is NaN, infinite or negative; what its boundary
// reflects, lets in and lets out is all light.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "aureole/bssrdf/bssrdf.h"
#include "aureole/math/significance.h"
#include "aureole/plugin/registry.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

struct Case {
  std::string name, xml;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const PluginInfo& plugin : Registry::instance().all()) {
    if (plugin.family != "bssrdf") continue;
    int i = 0;
    for (const std::string& example : plugin.doc.examples)
      all.push_back({plugin.name + "_" + std::to_string(++i), example});
  }
  return all;
}

Wavelengths wavelengths(int hero) {
  return Wavelengths::at(SpectralGrid{}, make_spectrum([&](int i) {
                           return 380.f + 440.f * float((i + hero) % kWavelengths) / float(kWavelengths);
                         }));
}

class BssrdfHarness : public ::testing::TestWithParam<Case> {};

/// The integral of f(r) 2 pi r over distances from 0, in steps of ln r.
template <class F>
Spectrum over_plane(float unit, F&& f) {
  constexpr int kSteps = 4000;
  const double first = std::log(double(unit) * 1e-7), last = std::log(double(unit) * 1e4);
  const double step = (last - first) / kSteps;
  std::array<double, kWavelengths> sum{};
  for (int i = 0; i < kSteps; ++i) {
    const double r = std::exp(first + (i + 0.5) * step);
    const Spectrum value = f(float(r));
    for (int k = 0; k < kWavelengths; ++k)
      sum[std::size_t(k)] += double(value[k]) * 2 * std::numbers::pi * r * r * step;
  }
  return make_spectrum([&](int k) { return float(sum[std::size_t(k)]); });
}

TEST_P(BssrdfHarness, DensityIntegratesToOneAndNoLightIsGained) {
  const auto model = build<Bssrdf>(GetParam().xml);
  const SurfacePoint point;
  for (const int hero : {0, 3}) {
    const Wavelengths w = wavelengths(hero);
    const BssrdfContext ctx{w, point};
    const float reach = model->reach(ctx);
    ASSERT_GT(reach, 0);
    const Spectrum mass = over_plane(reach, [&](float r) { return model->eval_pdf(r, ctx).pdf; });
    const Spectrum light = over_plane(reach, [&](float r) { return model->eval_pdf(r, ctx).value; });
    for (int k = 0; k < kWavelengths; ++k) {
      EXPECT_NEAR(mass[k], 1, 2e-3) << "wavelength " << k;
      EXPECT_LE(light[k], 1 + 1e-4);
      EXPECT_GE(light[k], 0);
    }
  }
}

TEST_P(BssrdfHarness, SamplesFollowTheDensity) {
  const auto model = build<Bssrdf>(GetParam().xml);
  const SurfacePoint point;
  constexpr std::size_t kSamples = 40000, kBins = 50;
  const double level = sidak_level(0.01, cases().size() * 2);
  SeededRandom random(5);
  for (const int hero : {0, 5}) {
    const Wavelengths w = wavelengths(hero);
    const BssrdfContext ctx{w, point};
    // Bins of ln r about the median; the rest of the mass lies outside.
    const double half = 4, first = std::log(double(model->sample_distance(0.5f, ctx))) - half;
    const double width = 2 * half / kBins;
    std::vector<std::size_t> counts(kBins);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float r = model->sample_distance(random.next(), ctx);
      ASSERT_TRUE(r >= 0 && std::isfinite(r));
      const double bin = (std::log(double(r)) - first) / width;
      if (bin >= 0 && bin < double(kBins)) ++counts[std::size_t(bin)];
    }
    std::vector<double> masses(kBins);
    for (std::size_t i = 0; i < kBins; ++i) {
      constexpr int kSteps = 32;
      for (int k = 0; k < kSteps; ++k) {
        const double r = std::exp(first + (double(i) + (k + 0.5) / kSteps) * width);
        masses[i] +=
            double(model->eval_pdf(float(r), ctx).pdf[0]) * 2 * std::numbers::pi * r * r * width / kSteps;
      }
    }
    const ChiSquareResult result = chi_square_test(masses, counts, kSamples);
    EXPECT_GT(result.p_value, level) << "hero " << hero << ", chi-square " << result.statistic;
  }
}

TEST_P(BssrdfHarness, IsFiniteAtTheEndsOfItsRange) {
  const auto model = build<Bssrdf>(GetParam().xml);
  const SurfacePoint point;
  const Wavelengths w = wavelengths(0);
  const BssrdfContext ctx{w, point};
  for (const float u : {0.f, 1e-7f, 0.5f, 0x1.fffffep-1f}) {
    const float r = model->sample_distance(u, ctx);
    EXPECT_TRUE(r >= 0 && std::isfinite(r)) << u;
  }
  for (const float r : {1e-12f, 1.f, 1e6f}) {
    const BssrdfEval e = model->eval_pdf(r, ctx);
    EXPECT_TRUE(is_valid_radiance(e.value) && is_valid_radiance(e.pdf)) << r;
  }
}

/// Light that enters and light that is reflected are all light, of a boundary that loses none.
TEST_P(BssrdfHarness, BoundaryAddsUp) {
  const auto model = build<Bssrdf>(GetParam().xml);
  const SurfacePoint point;
  const Wavelengths w = wavelengths(2);
  for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
    const BsdfContext ctx{w, point, mode};
    SeededRandom random(3);
    constexpr int kSamples = 4000;
    double sum = 0;
    const Vec3 wi = normalize({0.5f, 0.2f, 0.7f});
    for (int i = 0; i < kSamples; ++i) {
      const float u1 = random.next();
      const auto s = model->boundary()->sample(wi, u1, random.next2(), ctx);
      if (s) sum += double(s->value[0] / s->pdf[0]) / kSamples;
    }
    // Rough boundaries scatter light once and lose a little.
    EXPECT_NEAR(sum, 1, 0.02);
    EXPECT_FALSE(model->boundary()->sample({0, 0, -1}, 0.5f, {0.5f, 0.5f}, ctx));
  }
}

/// All light that leaves goes somewhere, as samples do.
TEST_P(BssrdfHarness, ExitScattersAllLightOutside) {
  const auto model = build<Bssrdf>(GetParam().xml);
  const SurfacePoint point;
  const Wavelengths w = wavelengths(1);
  const BsdfContext ctx{w, point};
  const Vec3 from = normalize({0.3f, 0, 0.9f});
  Spectrum light = 0.f, mass = 0.f;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const float mu = (float(i) + 0.5f) / kSteps;
    const BsdfEval e = model->exit().eval_pdf(from, {std::sqrt(1 - mu * mu), 0, mu}, ctx);
    light += e.value * (2 * kPi / kSteps), mass += e.pdf * (2 * kPi / kSteps);
  }
  for (int k = 0; k < kWavelengths; ++k) {
    EXPECT_NEAR(light[k], 1, 2e-3);
    EXPECT_NEAR(mass[k], 1, 1e-3);
  }
  SeededRandom random(9);
  for (int i = 0; i < 20; ++i) {
    const auto s = model->exit().sample(from, 0, random.next2(), ctx);
    ASSERT_TRUE(s && s->wo.z > 0);
    const BsdfEval e = model->exit().eval_pdf(from, s->wo, ctx);
    EXPECT_EQ(e.value[0], s->value[0]);
    EXPECT_EQ(e.pdf[0], s->pdf[0]);
  }
  EXPECT_TRUE(is_black(model->exit().eval_pdf(from, {0, 0, -1}, ctx).value));
}

INSTANTIATE_TEST_SUITE_P(Bssrdf, BssrdfHarness, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace aureole::testing
