// SPDX-License-Identifier: Apache-2.0
// Mixtures of scatterers and the tables made of them, against their formulas.
#include "aureole/optics/layer/scatterer_mixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "aureole/optics/aperture/polygon_aperture.h"
#include "aureole/optics/aperture/round_aperture.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "aureole/optics/layer/scatterer_table.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

std::shared_ptr<const ApertureShape> circle(double radius) {
  return std::make_shared<EllipseAperture>(radius, radius);
}

/// Without any symmetry, within a circle of radius 1.
std::shared_ptr<const ApertureShape> triangle() {
  return std::make_shared<PolygonAperture>(PolygonRegion::even_odd({{{-0.6, -0.5}, {0.9, 0.1}, {0.2, 0.8}}}));
}

ScattererMixture two_shapes() { return {{{circle(0.7), 0.4}, {triangle(), 0.6, 0.3}}, 1}; }

TEST(ScattererMixture, OfEqualCirclesIsTheirLayer) {
  const double a = 5e-6, b = 4e-6, fa = 0.4;
  const ScattererMixture mixture({{circle(b)}}, a);
  const ScattererLayer layer(b, a, fa);
  EXPECT_TRUE(mixture.is_uniform());
  EXPECT_NEAR(fa * mixture.covered_per_fraction(), layer.shape_fraction(), 1e-14);
  for (const double u : {0.0, 1.0, 2.7, 9.0}) {
    const MixtureIntensity m = mixture.eval(0.6 * u, -0.8 * u);
    const double j = fa / (kPi * a * a) * std::pow(a, 4) *
                     (m.uncorrelated + m.coherent * hard_disc_structure_factor(u, fa));
    EXPECT_NEAR(j, layer.intensity(u / a), 1e-12 * layer.intensity(0)) << u;
    EXPECT_LE(m.uncorrelated, 1e-15);
  }
}

TEST(ScattererMixture, IsTheVarianceAndTheMeanOfAmplitudes) {
  const ScattererMixture mixture = two_shapes();
  EXPECT_FALSE(mixture.is_isotropic());
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (const double u : {0.3, 2.0, 7.0})
    for (const double phi : {0.0, 1.0, 4.0}) {
      const double x = u * std::cos(phi), y = u * std::sin(phi);
      // The transform of a shape turned by an angle is the transform at q turned back.
      const std::complex<double> f = circle(0.7)->transform(x, y),
                                 g = triangle()->transform(x * c + y * s, y * c - x * s);
      const double coherent = std::norm(0.4 * f + 0.6 * g);
      const MixtureIntensity m = mixture.eval(x, y);
      EXPECT_NEAR(m.coherent, coherent, 1e-13);
      EXPECT_NEAR(m.uncorrelated, 0.4 * std::norm(f) + 0.6 * std::norm(g) - coherent, 1e-13);
    }
  EXPECT_THROW(ScattererMixture({{circle(1), 0.5}}, 1), std::domain_error);
  EXPECT_THROW(ScattererMixture({{circle(1.1)}}, 1), std::domain_error);
}

TEST(ScattererMixture, ShapesTurnedAtRandomHaveTheMeanOverAngles) {
  const ScattererMixture mixture({{triangle(), 1, 0, true}}, 1, std_thread_for());
  EXPECT_TRUE(mixture.is_isotropic());
  const double peak = std::pow(triangle()->area(), 2);
  for (const double u : {0.2, 2.0, 11.0, 60.0}) {
    std::complex<double> amplitude = 0;
    double intensity = 0;
    const int n = 720;
    for (int i = 0; i < n; ++i) {
      const auto f = triangle()->transform(u * std::cos(2 * kPi * i / n), u * std::sin(2 * kPi * i / n));
      amplitude += f / double(n), intensity += std::norm(f) / n;
    }
    const MixtureIntensity m = mixture.eval(u, 0);
    EXPECT_NEAR(m.coherent, std::norm(amplitude), 1e-6 * peak) << u;
    EXPECT_NEAR(m.uncorrelated, intensity - std::norm(amplitude), 1e-6 * peak) << u;
  }
}

TEST(IntensityMap, FollowsTheMixture) {
  const ScattererMixture mixture = two_shapes();
  const auto f = [&](double x, double y) { return mixture.eval(x, y); };
  const IntensityMap map(f, 80, std_thread_for());
  const double peak = mixture.eval(0, 0).coherent;
  double worst = 0;
  for (double u = 0; u < 79; u += 0.173)
    for (double phi = 0.05; phi < 2 * kPi; phi += 0.37) {
      const float x = float(u * std::cos(phi)), y = float(u * std::sin(phi));
      const MixtureIntensity exact = f(x, y);
      const IntensityMap::Pair found = map.eval(x, y);
      worst = std::max({worst, std::abs(double(found.uncorrelated) - exact.uncorrelated) / peak,
                        std::abs(double(found.coherent) - exact.coherent) / peak});
    }
  std::printf("map of a mixture: error %.1e of the peak\n", worst);
  EXPECT_LT(worst, 1e-5);
}

TEST(RingAzimuths, SamplesItsOwnDensity) {
  const ScattererMixture mixture = two_shapes();
  const RingAzimuths azimuths([&](double x, double y) { return mixture.eval(x, y).coherent; }, 80,
                              RingAzimuths::kShapes);
  for (const float u : {0.1f, 3.3f, 17.f, 70.f, 300.f}) {
    double mean = 0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double phi = 2 * kPi * (i + 0.5) / n;
      mean += double(azimuths.density(float(u * std::cos(phi)), float(u * std::sin(phi)), u)) / n;
    }
    EXPECT_NEAR(mean, 1, 2e-3) << u;
    // The density over the azimuth is the slope of xi over it.
    for (int i = 0; i < 200; ++i) {
      const float xi = (float(i) + 0.31f) / 200, step = 2e-5f;
      float c0, s0, c1, s1;
      azimuths.sample(u, xi - step, c0, s0);
      azimuths.sample(u, xi + step, c1, s1);
      EXPECT_NEAR(c0 * c0 + s0 * s0, 1, 1e-5);
      const double turned = std::asin(std::clamp(double(c0) * s1 - double(s0) * c1, -1.0, 1.0));
      const double before = azimuths.density(u * c0, u * s0, u), after = azimuths.density(u * c1, u * s1, u);
      if (before != after) continue;  // another bin
      EXPECT_NEAR(2 * step * 2 * kPi / turned / before, 1, 0.05) << u << " " << xi;
    }
  }
}

TEST(ScattererTable, ThreadsDoNotMatter) {
  // Serial, and on several numbers of threads: the same values to the last bit.
  std::vector<float> first;
  for (const int threads : {0, 1, 2, 5}) {
    const ParallelFor parallel_for = threads ? std_thread_for(threads) : ParallelFor(serial_for);
    const ScattererMixture mixture({{triangle(), 0.5, 0, true}, {triangle(), 0.5, 0.2}}, 1, parallel_for);
    const ScattererTable table(mixture, 80, nullptr, parallel_for);
    std::vector<float> values;
    for (float x = -90; x < 90; x += 3.7f)
      for (float y = -90; y < 90; y += 5.3f) {
        const float u = std::hypot(x, y);
        const auto p = table.eval(x, y, u);
        values.insert(values.end(), {p.uncorrelated, p.coherent, table.ring(u).coherent,
                                     table.coherent_azimuths().density(x, y, u)});
      }
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << threads;
  }
}

}  // namespace
}  // namespace aureole::optics
