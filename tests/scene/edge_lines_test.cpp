// SPDX-License-Identifier: Apache-2.0
// `EdgeLines` against the distance of every line from a ray.

#include "aureole/scene/edge/edge_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace aureole {
namespace {

class RandomLines {
public:
  Vec3 point(float size) {
    return {size * number_(random_), size * number_(random_), size * number_(random_)};
  }
  std::vector<MeshEdge> edges(int count, float size, float length) {
    std::vector<MeshEdge> all;
    for (int i = 0; i < count; ++i) {
      MeshEdge edge{};
      edge.a = point(size), edge.b = edge.a + point(length);
      all.push_back(edge);
    }
    return all;
  }

private:
  std::mt19937 random_{1};
  std::uniform_real_distribution<float> number_{-1, 1};
};

/// The distance of the endless line of an edge from that through `o` along `d`, by a projection along `d`.
double distance_of_lines(const MeshEdge& edge, const Double3& o, const Double3& d) {
  const auto across = [&](const Double3& v) { return v - d * dot(v, d); };
  const Double3 a = across(Double3(edge.a) - o), e = across(Double3(edge.b) - Double3(edge.a));
  return length(a - e * (dot(a, e) / dot(e, e)));
}

// With few edges all lines are tested, with many a tree is descended.
TEST(EdgeLines, FindAllLinesNearARay) {
  constexpr double kRadius = 0.3;
  RandomLines lines;
  int found = 0;
  for (const int count : {1, 3, 5, 96, 97, 400}) {
    std::vector<MeshEdge> edges = lines.edges(count, 10, 3);
    const EdgeLines index(edges);
    ASSERT_EQ(edges.size(), std::size_t(count));
    for (int k = 0; k < 1600; ++k) {
      const Double3 o(lines.point(10)), d = normalize(Double3(lines.point(1)));
      std::vector<int> visits(edges.size(), 0);
      const auto beam = [&] { return Beam{o.to_float(), d.to_float(), float(kRadius), 0, 40}; };
      index.visit(o, d, kRadius * kRadius, beam, [&](std::uint32_t i) { ++visits[i]; });
      bool is_any = false;
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const double distance = distance_of_lines(edges[i], o, d);
        EXPECT_LE(visits[i], 1);
        if (distance > kRadius * 1.001) EXPECT_EQ(visits[i], 0) << distance;
        // A tree finds the edges, not their lines, near the part of the ray in front of its origin.
        const Double3 middle = (Double3(edges[i].a) + Double3(edges[i].b)) * 0.5 - o;
        const bool is_near =
            distance < kRadius && length(middle - d * dot(middle, d)) < kRadius && dot(middle, d) > 3;
        if (is_near || (count <= 96 && distance < kRadius))
          EXPECT_EQ(visits[i], 1) << count << ", " << distance;
        is_any |= is_near;
        found += is_near;
      }
      if (is_any) EXPECT_TRUE(index.has_near(o, d, kRadius * kRadius));
    }
  }
  EXPECT_GT(found, 100);
}

// Far from the origin of coordinates, and with a small radius, single precision still finds each line. Rays far from all
// lines are clear.
TEST(EdgeLines, TellClearRays) {
  RandomLines lines;
  int clear = 0;
  for (const float away : {0.f, 1000.f})
    for (int k = 0; k < 2000; ++k) {
      std::vector<MeshEdge> edges = lines.edges(40, 1, 1);
      for (MeshEdge& edge : edges) edge.a = edge.a + Vec3{away, 0, 0}, edge.b = edge.b + Vec3{away, 0, 0};
      const EdgeLines index(edges);
      const Double3 o = Double3(lines.point(1)) + Double3{away, 0, 0}, d = normalize(Double3(lines.point(1)));
      double nearest = INFINITY;
      for (const MeshEdge& edge : edges) nearest = std::min(nearest, distance_of_lines(edge, o, d));
      EXPECT_TRUE(index.has_near(o, d, nearest * nearest * 1.0001)) << nearest;
      // The bound is at most 1.5 times too large.
      const double radius = nearest / 1.5;
      if (radius < 1e-4) continue;
      EXPECT_FALSE(index.has_near(o, d, radius * radius)) << nearest;
      ++clear;
    }
  EXPECT_GT(clear, 3000);
}

// A visitor that looks for the nearest line may make the radius smaller.
TEST(EdgeLines, NarrowWhileTheyAreVisited) {
  RandomLines lines;
  std::vector<MeshEdge> edges = lines.edges(2000, 10, 0.5f);
  const EdgeLines index(edges);
  for (int k = 0; k < 100; ++k) {
    const Double3 o(lines.point(10)), d = normalize(Double3(lines.point(1)));
    const auto beam = [&] { return Beam{o.to_float(), d.to_float(), 2, -40, 40}; };
    // The distance of an edge's middle stands for what is looked for.
    const auto distance2 = [&](std::size_t i) {
      const Double3 middle = (Double3(edges[i].a) + Double3(edges[i].b)) * 0.5 - o,
                    off = middle - d * dot(middle, d);
      return dot(off, off);
    };
    double reach = 4, least = 4;
    int visits = 0;
    index.visit(o, d, reach, beam, [&](std::uint32_t i) {
      ++visits;
      reach = std::min(reach, distance2(i));
    });
    int all = 0;
    for (std::size_t i = 0; i < edges.size(); ++i)
      least = std::min(least, distance2(i)), all += distance2(i) < 4;
    EXPECT_EQ(reach, least);
    if (all > 50) EXPECT_LT(visits, all);
  }
}

}  // namespace
}  // namespace aureole
