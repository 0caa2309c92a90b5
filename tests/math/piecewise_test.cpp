// SPDX-License-Identifier: Apache-2.0
// Piecewise-constant distributions against sums of their weights.
#include "aureole/math/piecewise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace aureole {
namespace {

std::vector<float> random_weights(unsigned seed, std::size_t n, double empty) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<float> w(n);
  for (float& x : w) x = uniform(random) < empty ? 0.f : float(std::exp(4 * uniform(random)));
  return w;
}

double sum(const std::vector<float>& w) { return std::accumulate(w.begin(), w.end(), 0.0); }

TEST(Piecewise1D, DensityIsWeightTimesCellsOverTotal) {
  for (std::size_t n : {1u, 2u, 3u, 17u, 1000u}) {
    const std::vector<float> w = random_weights(unsigned(n), n, n > 3 ? 0.3 : 0);
    const Piecewise1D d(w);
    EXPECT_EQ(d.size(), n);
    EXPECT_NEAR(d.total(), sum(w), 1e-6 * sum(w));
    for (std::size_t i = 0; i < n; ++i) {
      const double expected = double(w[i]) * double(n) / sum(w);
      EXPECT_NEAR(d.pdf((float(i) + 0.5f) / float(n)), expected, 1e-7 * double(n) + 1e-5 * expected);
      if (w[i] == 0) {
        EXPECT_EQ(d.pdf((float(i) + 0.5f) / float(n)), 0.f);
      }
    }
    EXPECT_EQ(d.pdf(1.f), d.pdf((float(n) - 0.5f) / float(n)));
  }
}

TEST(Piecewise1D, SamplesInvertTheDistributionFunction) {
  for (std::size_t n : {1u, 2u, 5u, 64u, 777u}) {
    const std::vector<float> w = random_weights(unsigned(n) + 5, n, n > 2 ? 0.4 : 0);
    const Piecewise1D d(w);
    const double total = sum(w);
    for (int k = 0; k <= 5000; ++k) {
      const float u = k == 5000 ? 0x1.fffffep-1f : float(k) / 5000;
      float pdf;
      std::size_t cell;
      const float x = d.sample(u, &pdf, &cell);
      ASSERT_GE(x, 0.f);
      ASSERT_LT(x, 1.f);
      ASSERT_GT(w[cell], 0) << "an empty cell was sampled at u = " << u;
      ASSERT_NEAR(double(x) * double(n), double(cell) + 0.5, 0.5 + 1e-4);
      ASSERT_NEAR(pdf, double(w[cell]) * double(n) / total, 1e-4 * pdf + 1e-7 * double(n));
      double below = 0;
      for (std::size_t i = 0; i < cell; ++i) below += w[i];
      below += double(w[cell]) * (double(x) * double(n) - double(cell));
      ASSERT_NEAR(below / total, u, 2e-6);
    }
  }
}

TEST(Piecewise1D, EmptyEndsAreNeverSampled) {
  const std::vector<float> w = {0, 0, 1, 0.1f, 0.3f, 0, 0};
  const Piecewise1D d(w);
  for (float u : {0.f, 0x1p-149f, 0x1p-24f, 0.5f, 1 - 0x1p-23f, 0x1.fffffep-1f}) {
    std::size_t cell;
    float pdf;
    d.sample(u, &pdf, &cell);
    EXPECT_GT(w[cell], 0) << u;
    EXPECT_GT(pdf, 0) << u;
  }
}

TEST(Piecewise1D, AllZeroIsUniform) {
  const Piecewise1D d(std::vector<float>(10, 0.f));
  EXPECT_EQ(d.total(), 0);
  for (int k = 0; k < 100; ++k) {
    float pdf;
    EXPECT_NEAR(d.sample(float(k) / 100, &pdf), k / 100.0, 1e-6);
    EXPECT_NEAR(pdf, 1, 1e-5);
    EXPECT_NEAR(d.pdf(float(k) / 100), 1, 1e-5);
  }
}

TEST(Piecewise1D, HugeRangesOfWeights) {
  std::vector<float> w(1000, 1e-30f);
  w[500] = 1e30f;
  const Piecewise1D d(w);
  float pdf;
  std::size_t cell;
  d.sample(0.4f, &pdf, &cell);
  EXPECT_EQ(cell, 500u);
  EXPECT_NEAR(pdf, 1000, 1e-3);
  double mass = 0;
  for (int i = 0; i < 1000; ++i) mass += d.pdf((float(i) + 0.5f) / 1000) / 1000;
  EXPECT_NEAR(mass, 1, 1e-5);
}

TEST(Piecewise2D, HistogramAndDensity) {
  const int width = 7, height = 5;
  std::vector<float> w = random_weights(3, std::size_t(width * height), 0.2);
  for (int x = 0; x < width; ++x) w[std::size_t(2 * width + x)] = 0;  // an empty row
  const Piecewise2D d(w, width, height);
  const double total = sum(w);
  std::vector<double> found(w.size());
  const int n = 700;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      float pdf;
      const Vec2 p = d.sample({(float(i) + 0.5f) / n, (float(j) + 0.5f) / n}, &pdf);
      const std::size_t cell = std::size_t(p.y * height) * width + std::size_t(p.x * width);
      found[cell] += 1.0 / (n * n);
      ASSERT_NEAR(pdf, double(w[cell]) * double(w.size()) / total, 1e-4 * pdf);
      ASSERT_EQ(pdf, d.pdf(p));
    }
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_NEAR(found[i], w[i] / total, 2.0 / n) << i;
}

TEST(Piecewise2D, SamplingIsContinuousInsideCells) {
  const Piecewise2D d(std::vector<float>{1, 3, 2, 2}, 2, 2);
  float pdf;
  // The first row has half the weight; its first cell a quarter of that.
  const Vec2 p = d.sample({0.125f, 0.25f}, &pdf);
  EXPECT_NEAR(p.x, 0.25, 1e-6);
  EXPECT_NEAR(p.y, 0.25, 1e-6);
  EXPECT_NEAR(pdf, 0.5, 1e-6);
  EXPECT_NEAR(d.pdf({0.75f, 0.25f}), 1.5, 1e-6);
  EXPECT_NEAR(d.pdf({0.75f, 0.75f}), 1, 1e-6);
}

TEST(Piecewise2D, AllZeroIsUniform) {
  const Piecewise2D d(std::vector<float>(12, 0.f), 4, 3);
  float pdf;
  const Vec2 p = d.sample({0.3f, 0.7f}, &pdf);
  EXPECT_NEAR(p.x, 0.3, 1e-6);
  EXPECT_NEAR(p.y, 0.7, 1e-6);
  EXPECT_NEAR(pdf, 1, 1e-5);
}

}  // namespace
}  // namespace aureole
