// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "aureole/instrument/check/direction_bins.h"
#include "aureole/math/significance.h"

namespace aureole {
namespace {

/// Chi-square of a warp to directions against its density, by the bins of the BSDF harness.
double direction_p_value(const std::function<Vec3(Vec2)>& warp,
                         const std::function<double(const Vec3&)>& pdf) {
  DirectionBins::Options options;
  options.tolerance = 1e-7;
  const DirectionBins bins([&](const Vec3& w) { return DirectionBins::Value{pdf(w), {}}; }, options);
  EXPECT_NEAR(bins.mass(), 1, 1e-3);
  SeededRandom random(3);
  constexpr std::size_t kSamples = 500000;
  std::vector<std::size_t> counts(bins.bins().size());
  for (std::size_t i = 0; i < kSamples; ++i) {
    const Vec3 w = warp(random.next2());
    EXPECT_NEAR(length(w), 1, 1e-6);
    ++counts[bins.find(w)];
  }
  return chi_square_test(bins.masses(), counts, kSamples, 200).p_value;
}

// Eight statistical tests in this file at 1 % together.
constexpr double kLevel = 0.01 / 8;

TEST(Warp, CosineHemisphere) {
  EXPECT_GT(direction_p_value(square_to_cosine_hemisphere,
                              [](const Vec3& w) { return cosine_hemisphere_pdf(w.z); }),
            kLevel);
}
TEST(Warp, UniformHemisphere) {
  EXPECT_GT(direction_p_value(square_to_uniform_hemisphere,
                              [](const Vec3& w) { return w.z > 0 ? uniform_hemisphere_pdf() : 0.f; }),
            kLevel);
}
TEST(Warp, UniformSphere) {
  EXPECT_GT(direction_p_value(square_to_uniform_sphere, [](const Vec3&) { return uniform_sphere_pdf(); }),
            kLevel);
}
TEST(Warp, UniformCone) {
  constexpr float kOneMinusCos = 0.3f;
  EXPECT_GT(direction_p_value(
                [](Vec2 u) { return square_to_uniform_cone(u, kOneMinusCos); },
                [](const Vec3& w) { return w.z > 1 - kOneMinusCos ? uniform_cone_pdf(kOneMinusCos) : 0.f; }),
            kLevel);
}

TEST(Warp, NarrowConeKeepsItsDigits) {
  // A cone of a microradian: 1 - cos = 5e-13 is lost in a cosine, not here.
  const Vec3 w = square_to_uniform_cone({1.f, 0.f}, 5e-13f);
  EXPECT_NEAR(std::hypot(w.x, w.y), 1e-6, 1e-12);
}

TEST(Warp, DiscIsUniform) {
  SeededRandom random(4);
  constexpr int kRings = 16, kSectors = 16, kSamples = 400000;
  std::vector<double> counts(kRings * kSectors);
  for (int i = 0; i < kSamples; ++i) {
    const DiscPoint d = square_to_disc_concentric(random.next2());
    const double r2 = double(dot(d.p, d.p)),
                 phi = std::atan2(double(d.p.y), double(d.p.x)) / (2 * M_PI) + 0.5;
    EXPECT_NEAR(std::sqrt(r2), d.radius, 3e-7);
    ++counts[std::min(int(r2 * kRings), kRings - 1) * kSectors + std::min(int(phi * kSectors), kSectors - 1)];
  }
  const double expected = double(kSamples) / double(counts.size());
  double statistic = 0;
  for (const double c : counts) statistic += (c - expected) * (c - expected) / expected;
  EXPECT_GT(chi_square_p_value(statistic, counts.size() - 1), kLevel);
}

TEST(Warp, TriangleIsUniform) {
  SeededRandom random(5);
  constexpr int kN = 12, kSamples = 400000;
  std::vector<double> counts(kN * kN);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 b = square_to_triangle(random.next2());
    ASSERT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 + 1e-6f);
    ++counts[std::min(int(b.x * kN), kN - 1) * kN + std::min(int(b.y * kN), kN - 1)];
  }
  double statistic = 0;
  std::size_t used = 0;
  for (int i = 0; i < kN; ++i)
    for (int j = 0; i + j < kN; ++j, ++used) {
      // Squares inside, and halves along the hypotenuse.
      const double expected = 2.0 * kSamples / (kN * kN) * (i + j == kN - 1 ? 0.5 : 1);
      statistic += (counts[i * kN + j] - expected) * (counts[i * kN + j] - expected) / expected;
    }
  EXPECT_GT(chi_square_p_value(statistic, used - 1), kLevel);
}

TEST(Warp, CosAndSinAreAccurate) {
  double largest = 0;
  for (int i = 0; i <= 1 << 20; ++i) {
    const float u = float(i) / (1 << 20);
    const Vec2 a = cos_sin_2pi(u);
    largest =
        std::max({largest, std::abs(a.x - std::cos(2 * M_PI * u)), std::abs(a.y - std::sin(2 * M_PI * u))});
  }
  EXPECT_LT(largest, 2.5e-7);
  RecordProperty("largest_error", std::to_string(largest));
}

TEST(Warp, EdgesOfTheSquareStayInside) {
  for (const float x : {0.f, 0x1p-24f, 0.5f, kOneMinusEpsilon})
    for (const float y : {0.f, 0x1p-24f, 0.5f, kOneMinusEpsilon}) {
      const Vec3 h = square_to_cosine_hemisphere({x, y});
      EXPECT_GT(h.z, 0) << x << " " << y;
      EXPECT_NEAR(length(h), 1, 1e-6);
      EXPECT_LT(square_to_disc_concentric({x, y}).radius, 1);
      for (const Vec3& w : {square_to_uniform_sphere({x, y}), square_to_uniform_hemisphere({x, y}),
                            square_to_uniform_cone({x, y}, 1e-4f)}) {
        EXPECT_TRUE(is_finite(w));
        EXPECT_NEAR(length(w), 1, 1e-6);
      }
      const Vec2 b = square_to_triangle({x, y});
      EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1);
    }
}

TEST(Warp, NeighboursStayNeighbours) {
  // Low distortion keeps stratification: a step in the square is a step of bounded length.
  constexpr float kStep = 1e-3f;
  for (float x = 0.01f; x < 0.98f; x += 0.01f)
    for (float y = 0.01f; y < 0.98f; y += 0.01f)
      for (const Vec2 d : {Vec2{kStep, 0}, Vec2{0, kStep}}) {
        const Vec2 a = square_to_disc_concentric({x, y}).p,
                   b = square_to_disc_concentric({x + d.x, y + d.y}).p;
        EXPECT_LT(std::hypot(a.x - b.x, a.y - b.y), 3 * kStep);
      }
}

}  // namespace
}  // namespace aureole
