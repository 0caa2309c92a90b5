// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_group.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace aureole::optics {
namespace {

// A group of edges sends in the mean over drawn wave vectors what its edges send by the mean kernel, each of them its share.
TEST(EdgeGroup, HasTheMeanOfItsEdges) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<ProjectedEdge> edges;
  constexpr int kCorners = 9;
  PlanePoint corners[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    const double r = 0.5 + uniform(engine), phi = 2 * M_PI * i / kCorners;
    corners[i] = {r * std::cos(phi), r * std::sin(phi)};
  }
  for (int i = 0; i < kCorners; ++i) {
    const PlanePoint a = corners[i], b = corners[(i + 1) % kCorners];
    edges.push_back({a, b, std::hypot(b.x - a.x, b.y - a.y) * (1 + 0.1 * i)});  // some are seen obliquely
  }
  // The share of each edge, per length.
  double shares[kCorners], all = 0;
  for (int j = 0; j < kCorners; ++j) {
    const ProjectedEdge& edge = edges[std::size_t(j)];
    shares[j] = std::pow((edge.to.y - edge.from.y) / edge.length, 2);
    all += shares[j] * edge.length;
  }
  for (double& share : shares) share /= all;
  for (const double turn : {0.03, 0.3, 1.2}) {
    const double k[4] = {10, 11, 20, 50}, sigma[4] = {0.3, 2, 1, 1};
    double whole[4] = {}, drawn[4] = {}, squares[4] = {}, result[4];
    for (std::size_t j = 0; j < edges.size(); ++j)
      for (int i = 0; i < 4; ++i)
        for (int n = 0; n < 400; ++n)
          whole[i] += edges[j].length / 400 *
                      mean_edge_kernel(edges, j, (n + 0.5) / 400, {k[i] * turn, 0}, k[i], sigma[i]);
    const int draws = 40000;
    for (int n = 0; n < draws; ++n) {
      const PlanePoint s{normal(engine), normal(engine)};
      drawn_edge_kernels(edges, 3, s, turn, k, sigma, result);
      double sum[4];
      for (int i = 0; i < 4; ++i) {
        sum[i] = result[i] / shares[3];
        drawn[i] += sum[i] / draws, squares[i] += sum[i] * sum[i] / draws;
      }
      if (n % 1000) continue;
      const std::size_t other = std::size_t(n / 1000) % kCorners;
      drawn_edge_kernels(edges, other, s, turn, k, sigma, result);
      for (int i = 0; i < 4; ++i) {
        EXPECT_GE(result[i], 0);
        EXPECT_NEAR(result[i], sum[i] * shares[other], 1e-12 * sum[i]) << other;
      }
    }
    for (int i = 0; i < 4; ++i) {
      const double error = std::sqrt((squares[i] - drawn[i] * drawn[i]) / draws);
      EXPECT_NEAR(drawn[i], whole[i], 5 * error + 1e-9 * whole[i]) << turn << " " << i;
      EXPECT_LT(error, 0.03 * drawn[i]) << turn << " " << i;
    }
  }
}

// Edges are chosen with the probabilities that are returned, all that have a length, and by their lengths.
TEST(EdgeGroup, ChoicesHaveTheirProbabilities) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  std::vector<EdgeGroup::Edge> edges;
  std::vector<double> lengths;
  double all = 0;
  for (int i = 0; i < 18; ++i) {
    const SpaceVector a{normal(engine), normal(engine), 0};
    const SpaceVector b = i == 4 ? a : SpaceVector{normal(engine), normal(engine), 0};
    // Some folds, of which one is no outline in light along z.
    edges.push_back({a,
                     b,
                     {0, 0, 1},
                     i == 7   ? SpaceVector{0, 0.6, 0.8}
                     : i == 8 ? SpaceVector{0, 0.6, -0.8}
                              : SpaceVector{}});
    lengths.push_back(std::hypot(b.x - a.x, b.y - a.y));
    all += lengths.back();
  }
  const EdgeGroup group(edges);
  constexpr int kDraws = 200000;
  const auto expect_frequencies = [&](const auto& choose, const char* what) {
    std::vector<double> counts(edges.size()), probabilities(edges.size());
    for (int i = 0; i < kDraws; ++i) {
      const EdgeGroup::Choice choice = choose((i + 0.5) / kDraws);
      counts[choice.index] += 1.0 / kDraws, probabilities[choice.index] = choice.probability;
    }
    double sum = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      EXPECT_NEAR(counts[i], probabilities[i], 2.0 / kDraws) << what << " " << i;
      sum += probabilities[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12) << what;
    return probabilities;
  };
  for (const SpaceVector y : {SpaceVector{1, 0, 0}, SpaceVector{0.6, 0.8, 0}, SpaceVector{}}) {
    const auto p = expect_frequencies([&](double u) { return group.choose({0, 0, 1}, y, u); }, "by light");
    for (std::size_t i = 0; i < edges.size(); ++i) {
      EXPECT_GE(p[i], 0.2499 * lengths[i] / all) << i;
      EXPECT_EQ(p[i] > 0, i != 4);
    }
    EXPECT_NEAR(p[7], (y.x == 0 ? 1 : 0.25) * lengths[7] / all, 1e-12);
  }
  for (const std::size_t without : {EdgeGroup::kNone, std::size_t(2), std::size_t(4), std::size_t(17)}) {
    const auto p =
        expect_frequencies([&](double u) { return group.choose_by_length(u, without).value(); }, "by length");
    const double rest = all - (without == EdgeGroup::kNone ? 0 : lengths[without]);
    for (std::size_t i = 0; i < edges.size(); ++i)
      EXPECT_NEAR(p[i], i == without ? 0 : lengths[i] / rest, 1e-12) << i;
  }
  const EdgeGroup one({edges.data(), 1});
  EXPECT_FALSE(one.choose_by_length(0.5, 0));
}

// Edges in space, far from the origin, boundaries and folds: the group sends what its outlines send as they are seen in a plane.
TEST(EdgeGroup, IsThatOfItsOutlinesInAPlane) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  const auto dot = [](SpaceVector a, SpaceVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const auto cross = [](SpaceVector a, SpaceVector b) {
    return SpaceVector{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto unit = [&](SpaceVector v) {
    const double size = std::sqrt(dot(v, v));
    return SpaceVector{v.x / size, v.y / size, v.z / size};
  };
  const auto random = [&] { return SpaceVector{normal(engine), normal(engine), normal(engine)}; };
  int outlines = 0, others = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<EdgeGroup::Edge> edges;
    const int count = 17 + trial % 4;
    for (int i = 0; i < count; ++i) {
      SpaceVector a = random(), b = random();
      a.x += 1e3, b.x += 1e3;
      if (i == 5) b = a;  // of no extent
      edges.push_back({a, b, unit(random()), i % 3 ? SpaceVector{} : unit(random())});
    }
    const SpaceVector d = unit(random()), x = unit(cross(d, random())), y = cross(d, x);
    const double turn = trial % 2 ? 0.01 : 0.4;
    // Wavelengths of a band, and some of which one stands for all.
    double k[8], sigma[8], result[8], expected[8];
    for (int i = 0; i < 8; ++i) k[i] = trial % 3 ? 20 + i : 20 + 1e-9 * i, sigma[i] = 10 / k[i];
    const PlanePoint drawn{normal(engine), normal(engine)};
    std::vector<ProjectedEdge> projected;
    std::vector<int> number(edges.size(), -1);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto& [a, b, n0, n1] = edges[i];
      const bool is_boundary = n1.x == 0 && n1.y == 0 && n1.z == 0;
      if (!is_boundary && dot(n0, d) * dot(n1, d) > 0) continue;
      const PlanePoint from{dot(a, x), dot(a, y)}, to{dot(b, x), dot(b, y)};
      const SpaceVector way{b.x - a.x, b.y - a.y, b.z - a.z};
      number[i] = int(projected.size());
      const bool left = dot(n0, d) < 0;
      projected.push_back({left ? from : to, left ? to : from, std::sqrt(dot(way, way))});
    }
    const EdgeGroup group(edges);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      group.drawn_kernels(i, d, x, drawn, turn, k, sigma, result);
      if (number[i] < 0) {
        ++others;
        for (const double value : result) EXPECT_EQ(value, 0);
        continue;
      }
      ++outlines;
      drawn_edge_kernels(projected, std::size_t(number[i]), drawn, turn, k, sigma, expected);
      for (int j = 0; j < 8; ++j)
        EXPECT_NEAR(result[j], expected[j], 1e-9 * expected[j]) << trial << " " << i;
    }
  }
  EXPECT_GT(outlines, 500);
  EXPECT_GT(others, 50);
}

}  // namespace
}  // namespace aureole::optics
