// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/upsampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "aureole/spectrum/upsampling_fit.h"

namespace aureole {
namespace {

double largest_difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

SigmoidSpectrum from_table(const Rgb& c) {
  return upsample_srgb(static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]));
}

/// Colours of every kind: uniform; on the faces of the cube; dark; nearly white; near the saturated edges;
/// 8-bit.
Rgb random_colour(std::mt19937_64& generator, int kind) {
  std::uniform_real_distribution<double> uniform;
  Rgb c{uniform(generator), uniform(generator), uniform(generator)};
  const auto face = static_cast<std::size_t>(generator() % 3);
  for (double& v : c) {
    if (kind == 3) v = v * v * v * v;
    if (kind == 4) v = 1 - 0.03 * v;
    if (kind == 5) v = v > 0.5 ? 1 - 0.06 * (v - 0.5) : 0.06 * v;
    if (kind == 6) {
      const double code = std::floor(v * 256) / 255;
      v = std::min(1.0, code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
    }
  }
  if (kind == 1) c[face] = 0;
  if (kind == 2) c[face] = 1;
  return c;
}

TEST(Fit, ReachesEveryColourOfTheCube) {
  std::mt19937_64 generator(1);
  double worst = 0;
  for (int i = 0; i < 7000; ++i) {
    const Rgb colour = random_colour(generator, i % 7);
    worst = std::max(worst, delta_e(colour, srgb_of_reflectance(fit_srgb(colour))));
  }
  EXPECT_LT(worst, 2e-3);
  RecordProperty("worst_delta_e", std::to_string(worst));
}

TEST(Fit, ReachesTheCornersAndEdges) {
  for (double r : {0.0, 1e-6, 1e-3, 0.5, 0.999, 0.9999, 1.0})
    for (double g : {0.0, 1e-6, 1e-3, 0.5, 0.999, 0.9999, 1.0})
      for (double b : {0.0, 1e-6, 1e-3, 0.5, 0.999, 0.9999, 1.0}) {
        const Rgb colour{r, g, b};
        EXPECT_LT(delta_e(colour, srgb_of_reflectance(fit_srgb(colour))), 3e-3) << r << " " << g << " " << b;
      }
}

TEST(Fit, WhiteIsExactlyWhite) {
  const Rgb white = srgb_of_reflectance(fit_srgb({1, 1, 1}));
  EXPECT_LT(largest_difference(white, {1, 1, 1}), 1e-12);
}

TEST(Fit, AgreesWithThePublishedModel) {
  // Values of Mitsuba 3.9 (variant scalar_spectral, `rgb` textures) at 400, 450, ..., 700 nm: another
  // optimiser and table of the same model.
  constexpr double kColours[3][3] = {{0.8, 0.2, 0.1}, {0.1, 0.3, 0.9}, {0.9, 0.9, 0.2}};
  constexpr double kExpected[3][7] = {{0.16379, 0.11865, 0.13001, 0.22142, 0.55379, 0.88888, 0.96922},
                                      {0.96175, 0.86814, 0.55296, 0.26339, 0.17773, 0.18506, 0.29823},
                                      {0.03410, 0.19884, 0.72784, 0.88825, 0.90753, 0.85960, 0.55833}};
  for (int i = 0; i < 3; ++i) {
    const SigmoidSpectrum s = fit_srgb({kColours[i][0], kColours[i][1], kColours[i][2]});
    for (int k = 0; k < 7; ++k)
      EXPECT_NEAR(s.at(400.f + 50.f * static_cast<float>(k)), kExpected[i][k], 2e-3);
  }
}

TEST(Table, RoundTripStaysWithinItsStatedError) {
  // The bounds stand in the docstring of upsample_srgb.
  std::mt19937_64 generator(2);
  double worst_delta_e = 0, worst_rgb = 0, sum = 0;
  constexpr int kCount = 70000;
  for (int i = 0; i < kCount; ++i) {
    const Rgb colour = random_colour(generator, i % 7);
    const Rgb back = srgb_of_reflectance(from_table(colour));
    const double difference = delta_e(colour, back);
    sum += difference;
    worst_delta_e = std::max(worst_delta_e, difference);
    worst_rgb = std::max(worst_rgb, largest_difference(colour, back));
  }
  EXPECT_LT(worst_delta_e, 0.25);
  EXPECT_LT(worst_rgb, 3e-3);
  EXPECT_LT(sum / kCount, 0.03);
  RecordProperty("worst_delta_e", std::to_string(worst_delta_e));
  RecordProperty("worst_rgb", std::to_string(worst_rgb));
  RecordProperty("mean_delta_e", std::to_string(sum / kCount));
}

TEST(Table, AgreesWithTheDirectFit) {
  // Metamers: spectra may differ more than their colours do, most at the ends, where the observer is nearly
  // blind, and for bright saturated colours, whose spectra are steep.
  std::mt19937_64 generator(3);
  float worst = 0;
  double sum = 0;
  int count = 0;
  for (int i = 0; i < 3000; ++i) {
    const Rgb c = random_colour(generator, 0);
    const SigmoidSpectrum table = from_table(c), fit = fit_srgb(c);
    for (float nm = 400; nm <= 700; nm += 10, ++count) {
      const float difference = std::abs(table.at(nm) - fit.at(nm));
      worst = std::max(worst, difference);
      sum += difference;
    }
  }
  EXPECT_LT(worst, 0.01f);
  EXPECT_LT(sum / count, 5e-4);
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(sum / count));
}

TEST(Table, GreysAreConstantAndExact) {
  for (float v : {0.f, 1e-6f, 1e-3f, 0.18f, 0.5f, 0.73f, 0.999f, 1.f}) {
    const SigmoidSpectrum s = upsample_srgb(v, v, v);
    EXPECT_EQ(s.polynomial.c0, 0.f);
    EXPECT_EQ(s.polynomial.c1, 0.f);
    EXPECT_TRUE(std::isfinite(s.polynomial.c2));
    for (float nm : {360.f, 555.f, 830.f}) EXPECT_NEAR(s.at(nm), v, 3e-6f * v);
  }
  EXPECT_EQ(upsample_srgb(0, 0, 0).at(500), 0.f);
  EXPECT_EQ(upsample_srgb(1, 1, 1).at(500), 1.f);
  EXPECT_EQ(SigmoidPolynomial{}.at(500), 0.f);
}

TEST(Table, IsFiniteAndBoundedEverywhere) {
  using Limits = std::numeric_limits<float>;
  const float values[] = {0.f,
                          Limits::denorm_min(),
                          1e-38f,
                          1e-30f,
                          1e-7f,
                          1e-4f,
                          0.1f,
                          0.5f,
                          0.9999f,
                          std::nextafter(1.f, 0.f),
                          1.f,
                          2.f,
                          -1.f,
                          Limits::infinity(),
                          Limits::quiet_NaN()};
  for (float r : values)
    for (float g : values)
      for (float b : values) {
        const SigmoidSpectrum s = upsample_srgb(r, g, b);
        const SigmoidPolynomial& p = s.polynomial;
        ASSERT_TRUE(std::isfinite(p.c0) && std::isfinite(p.c1) && std::isfinite(p.c2) &&
                    std::abs(s.scale) <= 1)
            << r << " " << g << " " << b;
        for (float nm = 300; nm <= 900; nm += 7) {
          ASSERT_GE(s.at(nm), 0.f);
          ASSERT_LE(s.at(nm), 1.f);
        }
        const SigmoidSpectrum u = upsample_unbounded(r, g, b);
        ASSERT_TRUE(std::isfinite(u.scale) && std::isfinite(u.at(555.f))) << r << " " << g << " " << b;
      }
}

TEST(Table, IsContinuousAcrossCellsAndGreys) {
  // Neighbouring colours have neighbouring spectra: the three sub-tables meet where two components are equal.
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<float> uniform(0.05f, 0.95f);
  for (int i = 0; i < 2000; ++i) {
    const float a = uniform(generator), b = uniform(generator), e = 1e-5f;
    const SigmoidSpectrum s = upsample_srgb(a + e, a, b), t = upsample_srgb(a, a + e, b);
    const SigmoidSpectrum grey = upsample_srgb(a, a, a), near_grey = upsample_srgb(a, a + e, a);
    for (float nm = 380; nm <= 780; nm += 20) {
      EXPECT_NEAR(s.at(nm), t.at(nm), 0.015f) << a << " " << b;
      EXPECT_NEAR(grey.at(nm), near_grey.at(nm), 5e-3f) << a;
    }
  }
}

TEST(Table, GoesOnFlatOutsideTheVisible) {
  const SigmoidSpectrum s = upsample_srgb(0.9f, 0.2f, 0.4f);
  EXPECT_EQ(s.at(200), s.at(360));
  EXPECT_EQ(s.at(2000), s.at(830));
}

TEST(Unbounded, ScalesTheLargestComponentToAHalf) {
  const SigmoidSpectrum u = upsample_unbounded(10.f, 20.f, 250.f);
  EXPECT_EQ(u.scale, 500.f);
  const Rgb back = srgb_of_reflectance({u.polynomial, 1});
  EXPECT_LT(largest_difference({500 * back[0], 500 * back[1], 500 * back[2]}, {10, 20, 250}), 0.5);
  EXPECT_EQ(upsample_unbounded(0, 0, 0).scale, 0.f);
  EXPECT_EQ(upsample_unbounded(0, 0, 0).at(500), 0.f);
  EXPECT_EQ(upsample_unbounded(-1, -2, -3).at(500), 0.f);
  EXPECT_FLOAT_EQ(upsample_unbounded(3, 3, 3).at(500), 3.f);
  EXPECT_FLOAT_EQ(upsample_unbounded(1e-20f, 1e-20f, 1e-20f).at(500), 1e-20f);
}

}  // namespace
}  // namespace aureole
