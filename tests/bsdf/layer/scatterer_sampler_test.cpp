// SPDX-License-Identifier: Apache-2.0
// The strategies that draw diffracted waves: their samples against their densities.
#include "aureole/bsdf/layer/scatterer_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "aureole/math/significance.h"
#include "bsdf/layer/mixture_cases.h"
#include "harness/effort.h"

namespace aureole {
namespace {

using namespace testing::mixture_cases;
constexpr double kPi = std::numbers::pi;

struct Strategy {
  const char* name;
  std::function<std::shared_ptr<ScattererSampler>(std::shared_ptr<ScattererModel>)> make;
};

/// Chi-square of waves against the density over rings and azimuths, and the integral of the density.
void check_sampler(const std::string& what, const ScattererModel& model, const ScattererSampler& sampler,
                   float fa, double u_max, bool within, unsigned seed) {
  const auto state = model.at(fa);
  constexpr int kAzimuths = 16;
  const int kSamples = test::effort(60000, 200000);
  const int kRings = int(4 * u_max);
  const double end = u_max;
  const auto bin_of = [&](double x, double y) {
    const double u = std::hypot(x, y);
    double f = std::atan2(y, x) / (2 * kPi);
    f -= std::floor(f);
    return std::min(kRings - 1, int(4 * u)) * kAzimuths + std::min(int(f * kAzimuths), kAzimuths - 1);
  };
  std::vector<double> expected(kRings * kAzimuths), observed(kRings * kAzimuths);
  const Spectrum limit{float(u_max)};
  const double step = test::effort(1.0 / 16, 1.0 / 32);
  double mass = 0, worst_ratio = 0, weighted = 0;
  const RingPoints points(model.is_isotropic() ? 64 : 2048, 2 * kPi);
  const int n = points.count(), points_per_bin = n / kAzimuths;
  for (double u = step / 2; u < end; u += step)
    for (int i = 0; i < n; i += kWavelengths) {  // points are looked up together
      const DiffractedWave w = points.at(u, i);
      const Spectrum density = sampler.density(state, w, limit), intensity = model.intensity(state, w);
      for (int j = 0; j < kWavelengths; ++j) {
        const double d = double(density[j]) * u * step / n, g = double(intensity[j]) * u * step / n;
        expected[std::size_t(int(4 * u) * kAzimuths + (i + j) / points_per_bin)] += d * kSamples, mass += d;
        if (g > 0 && d > 0) worst_ratio = std::max(worst_ratio, g / d), weighted += g * g / d;
      }
    }
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 0.9999999f);
  for (int i = 0; i < kSamples; ++i) {
    float xi = uniform(random);
    const Vec2 u2{uniform(random), uniform(random)};
    const auto w = sampler.sample(state, xi, u2, u_max);
    ASSERT_TRUE(xi >= 0 && xi < 1) << what << " " << xi;
    if (std::hypot(w.x, w.y) < end) observed[bin_of(w.x, w.y)] += 1;
  }
  double statistic = 0, pooled_expected = 0, pooled_observed = 0;
  std::size_t bins = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    pooled_expected += expected[i], pooled_observed += observed[i];
    if (pooled_expected < 20 && i + 1 < expected.size()) continue;
    statistic += std::pow(pooled_observed - pooled_expected, 2) / std::max(pooled_expected, 1.0);
    pooled_expected = pooled_observed = 0, ++bins;
  }
  const double p = chi_square_p_value(statistic, bins - 1);
  std::printf("%-42s mass %.4f, chi-square p %.3f, largest J/D %.1f, second moment of J/D %.3f\n",
              what.c_str(), mass, p, worst_ratio, weighted);
  if (within) {                                                          // the table's square reaches further
    EXPECT_NEAR(mass, 1, model.is_anisotropic() ? 8e-3 : 2e-3) << what;  // as many angles here as bins there
  }
  EXPECT_GT(p, 1e-5) << what;
}

TEST(ScattererSampler, StrategiesFollowTheirDensities) {
  const std::vector<Strategy> strategies = {
      {"product", [](auto m) { return std::make_shared<ProductSampler>(m); }},
      {"factor_mis", [](auto m) { return std::make_shared<FactorSampler>(m); }},
      {"table", [](auto m) { return std::make_shared<TableSampler>(m, 40); }}};
  unsigned seed = 1;
  for (MixtureCase layer : layers()) {
    layer.extent = 40;
    const auto fixed = layer.model(0.5, 0.5), varying = layer.model(0.1, 0.7);
    for (const Strategy& s : strategies) {
      check_sampler(layer.name + ", " + s.name, *fixed, *s.make(fixed), 0.5f, 25,
                    s.name != std::string("table"), ++seed);
      if (s.name == std::string("table")) continue;
      check_sampler(layer.name + ", " + s.name + ", between nodes", *varying, *s.make(varying), 0.237f, 25,
                    true, ++seed);
    }
  }
}

TEST(ScattererSampler, EveryCorrelation) {
  unsigned seed = 100;
  for (
      const char* correlation :
      {R"(<correlation type="poisson"/>)", R"(<correlation type="lattice"/>)",
       R"(<correlation type="lattice"><string name="lattice" value="square"/><float name="jitter" value="0.1"/></correlation>)",
       R"(<correlation type="lattice"><boolean name="random_orientation" value="true"/></correlation>)",
       R"(<correlation type="percus_yevick"><float name="stretch" value="2"/></correlation>)"})
    for (const std::size_t which : {0u, 5u}) {
      if (which == 0 && !test::is_thorough()) continue;  // the other one has two shapes
      MixtureCase layer = layers()[which];
      layer.extent = 40;
      const auto model = layer.model(0.5, 0.5, correlation);
      check_sampler(layer.name + " " + correlation, *model, ProductSampler(model), 0.5f, 25, true, ++seed);
      check_sampler(layer.name + " factors", *model, FactorSampler(model), 0.5f, 25, true, ++seed);
    }
}

}  // namespace
}  // namespace aureole
