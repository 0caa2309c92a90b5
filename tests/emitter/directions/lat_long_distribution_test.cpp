// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/directions/lat_long_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "aureole/math/significance.h"
#include "aureole/math/warp.h"

namespace aureole {
namespace {

constexpr int kColumns = 3 * LatLongDistribution::kBlockColumns, kRows = 5 * LatLongDistribution::kBlockRows;

struct Map {
  const char* name;
  std::function<float(int x, int y)> weight;
};

const Map kMaps[] = {
    {"flat", [](int, int) { return 1.f; }},
    {"empty", [](int, int) { return 0.f; }},
    {"one cell", [](int x, int y) { return x == 40 && y == 21 ? 3e20f : 0.f; }},
    {"last cell", [](int x, int y) { return x == kColumns - 1 && y == kRows - 1 ? 1e-20f : 0.f; }},
    {"one row", [](int, int y) { return y == 33 ? 1.f : 0.f; }},
    {"sun and dim half",
     [](int x, int y) { return x == 7 && y == 11 ? 1e6f
                               : y > 40          ? 0.f
                                                 : 1e-6f * float(1 + x % 5); }},
    {"holes", [](int x, int y) { return (x * 7 + y * 5) % 3 == 0 ? float(1 + x + y) : 0.f; }},
};

const Vec3 kNormals[] = {{0, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0.6f, 0, -0.8f}, normalize(Vec3{-1, 0.2f, 0.4f})};

std::vector<float> weights_of(const Map& map) {
  std::vector<float> w;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) w.push_back(map.weight(x, y));
  return w;
}

Vec3 direction(Vec2 uv) {
  const Vec2 phi = cos_sin_2pi(uv.x), theta = cos_sin_2pi(0.5f * uv.y);
  return {phi.y * theta.y, theta.x, -phi.x * theta.y};
}

TEST(LatLongDistribution, DensityIsPositiveWhereTheWeightIsAndIntegratesToOne) {
  for (const Map& map : kMaps) {
    const std::vector<float> w = weights_of(map);
    const LatLongDistribution distribution(w, kColumns, kRows, Frame::from_normal({0, 0, 1}));
    const bool empty = std::string(map.name) == "empty";
    for (const Vec3& n : kNormals) {
      double mass = 0;
      for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < kColumns; ++x) {
          const float p =
              distribution.pdf(n, {(float(x) + 0.5f) / float(kColumns), (float(y) + 0.5f) / float(kRows)});
          mass += double(p) / (kColumns * kRows);
          ASSERT_EQ(p > 0, empty || w[size_t(y * kColumns + x)] > 0) << map.name << " " << x << " " << y;
        }
      EXPECT_NEAR(mass, 1, 1e-4) << map.name << " " << n.x << " " << n.y;
    }
  }
}

TEST(LatLongDistribution, SamplesHaveTheirDensityAndWeight) {
  SeededRandom random(1);
  for (const Map& map : kMaps) {
    const std::vector<float> w = weights_of(map);
    const LatLongDistribution distribution(w, kColumns, kRows, Frame::from_normal({0, 0, 1}));
    for (const Vec3& n : kNormals) {
      int off = 0;
      for (int k = 0; k < 3000; ++k) {
        const float ends[] = {0, kOneMinusEpsilon, 0.5f};
        const Vec2 u = k < 9 ? Vec2{ends[k % 3], ends[k / 3]} : random.next2();
        float pdf = -1;
        const Vec2 uv = distribution.sample(n, u, &pdf);
        ASSERT_TRUE(pdf > 0 && std::isfinite(pdf)) << map.name << " " << u.x << " " << u.y;
        ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1);
        off += std::abs(distribution.pdf(n, uv) - pdf) > 1e-3f * pdf;  // pushed over an edge by rounding
      }
      EXPECT_LE(off, 9) << map.name;  // the ends of the random numbers, on maps with edges
    }
  }
}

/// The worst case of the estimate's error, and of the horizon inside blocks: light that is the same
/// everywhere.
TEST(LatLongDistribution, FollowsTheCosine) {
  std::vector<float> w;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) w.push_back(std::sin(kPi * (float(y) + 0.5f) / float(kRows)));
  const Frame turned = Frame::from_normal(normalize(Vec3{1, 2, -0.5f}));
  const LatLongDistribution distribution(w, kColumns, kRows, turned);
  SeededRandom random(2);
  for (const Vec3& n : kNormals) {
    if (n == Vec3{}) continue;
    double sum = 0, squares = 0;
    const int draws = 20000;
    for (int k = 0; k < draws; ++k) {
      float pdf;
      const Vec2 uv = distribution.sample(n, random.next2(), &pdf);
      const double density = double(pdf) / (2 * M_PI * M_PI * std::sin(M_PI * double(uv.y)));
      const double x = std::max(0.0, double(dot(turned.to_world(direction(uv)), n))) / density;
      sum += x, squares += x * x;
    }
    const double mean = sum / draws, variance = squares / (draws * mean * mean) - 1;
    EXPECT_NEAR(mean, M_PI, 0.05);
    // By the map alone it is 5/3.
    EXPECT_LT(variance, 0.06) << n.x << " " << n.y << " " << n.z;
    RecordProperty("variance", std::to_string(variance));
  }
}

}  // namespace
}  // namespace aureole
