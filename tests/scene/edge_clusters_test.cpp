// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "aureole/core/keyed_random.h"
#include "scene/triangles.h"

namespace aureole {
namespace {

using test::Triangles;

TEST(EdgeClusters, AreGroupsApartThatFitABeam) {
  Triangles t;
  t.add_disc({0, 0, 0}, 1, 20);    // a cluster
  t.add_disc({100, 0, 0}, 1, 20);  // two that are near one another, together too long
  t.add_disc({105, 0, 0}, 1, 20);
  t.add_disc({200, 0, 0}, 1, 20);  // two that fit together
  t.add_disc({202.5f, 0, 0}, 0.2f, 8);
  t.add_disc({300, 0, 0}, 1, 5);   // too few edges
  t.add_disc({400, 0, 0}, 1, 20);  // beside an edge that is too long
  t.add({401, 10, 0}, {402, -10, 0}, {402, 10, 0});
  const EdgeIndex index = t.index();
  const EdgeClusters clusters(index, 3);
  EXPECT_EQ(clusters.size(), 2u);
  const auto& edges = index.edges();
  std::size_t in_clusters = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto cluster = clusters.of(i);
    const int place = int(std::lround(edges[i].a.x / 100));
    EXPECT_EQ(cluster.size(), place == 0 ? 20u : place == 2 ? 28u : 0u) << edges[i].a.x;
    if (cluster.empty()) continue;
    ++in_clusters;
    EXPECT_NE(std::find(cluster.begin(), cluster.end(), i), cluster.end());
    for (const std::uint32_t other : cluster) EXPECT_EQ(int(std::lround(edges[other].a.x / 100)), place);
  }
  EXPECT_EQ(in_clusters, 48u);
  EXPECT_EQ(EdgeClusters(index, 0.05f).size(), 0u);  // narrower than the discs
  EXPECT_EQ(EdgeClusters(index, 1000).size(), 1u);   // all of them in one
  EXPECT_TRUE(EdgeClusters().of(0).empty());
}

// No edge of a cluster has an edge of another group within the distance.
TEST(EdgeClusters, HaveNoOthersNearby) {
  KeyedRandom random(5);
  Triangles t;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{24 * random.next(), 24 * random.next(), 24 * random.next()};
    t.add_disc(p, 0.05f + 0.6f * random.next(), 6 + int(14 * random.next()));
  }
  const EdgeIndex index = t.index();
  const float coherent = 1;
  const EdgeClusters clusters(index, coherent);
  EXPECT_GT(clusters.size(), 10u);
  const auto& edges = index.edges();
  std::size_t apart = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto own = clusters.of(i);
    apart += own.empty();
    if (own.empty()) continue;
    EXPECT_GE(own.size(), EdgeClusters::kFewest);
    const std::set<std::uint32_t> members(own.begin(), own.end());
    for (std::size_t j = 0; j < edges.size(); ++j) {
      const float ends = std::min({length(edges[i].a - edges[j].a), length(edges[i].a - edges[j].b),
                                   length(edges[i].b - edges[j].a), length(edges[i].b - edges[j].b)});
      if (ends < coherent) {
        EXPECT_TRUE(members.contains(std::uint32_t(j)));
      }
    }
  }
  EXPECT_GT(apart, 100u);
}

}  // namespace
}  // namespace aureole
