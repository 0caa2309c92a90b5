// SPDX-License-Identifier: Apache-2.0
// Edges that go on straight: lines cut in pieces by meshes that touch, and what is none.
#include "aureole/scene/edge/straight_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "scene/triangles.h"

namespace aureole {
namespace {

using test::Triangles;

/// A strip of rectangles along (1, 1, 0), apart from each other by the rounding of their vertices.
Triangles strip(int pieces) {
  Triangles sheet;
  for (int i = 0; i < pieces; ++i) {
    const float half = 5.f / float(pieces), middle = float(-5 + 5.0 / pieces * (2 * i + 1));
    const Vec3 a{middle - half, middle - half, 0}, b{middle + half, middle + half, 0}, up{-1, 1, 0};
    sheet.add(a, b, b + up), sheet.add(a, b + up, a + up);
  }
  return sheet;
}

TEST(StraightEdges, AStripInPiecesHasTwoLongOnes) {
  for (const int pieces : {1, 7, 1000}) {
    const EdgeIndex index = strip(pieces).index();
    const StraightEdges straight(index);
    const auto size = float(10 * std::numbers::sqrt2);
    int on_long = 0;
    std::set<std::uint32_t> lines;
    for (std::size_t i = 0; i < index.edges().size(); ++i) {
      const StraightEdges::Place place = straight.of(i);
      const float own = length(index.edges()[i].b - index.edges()[i].a),
                  all = place.before + own + place.after;
      lines.insert(place.line);
      if (std::abs(all - size) > 1e-3f) continue;
      ++on_long;
      // From the edge's own ends: x + y of both ends of each long side differ by 20.
      const Vec3 e = normalize(index.edges()[i].b - index.edges()[i].a);
      const Vec3 begin = index.edges()[i].a - e * place.before;
      EXPECT_NEAR(std::abs(begin.x + begin.y), 10, 0.01f);
    }
    EXPECT_EQ(on_long, 2 * pieces);
    EXPECT_EQ(lines.size(), 4u);
  }
}

TEST(StraightEdges, BendsAndFoldsEndThem) {
  // A rim whose sides turn by 1.6 mrad each.
  Triangles disc;
  const int sides = 4000;
  disc.add_disc({0, 0, 0}, 1, sides);
  const EdgeIndex index = disc.index();
  const StraightEdges straight(index);
  ASSERT_EQ(index.edges().size(), std::size_t(sides));
  for (std::size_t i = 0; i < index.edges().size(); ++i)
    EXPECT_LT(straight.of(i).before + straight.of(i).after, 0.002f);

  // Two rectangles side by side along x, the second one turned about the line of their lower borders.
  Triangles twisted;
  twisted.add({0, 0, 0}, {1, 0, 0}, {1, 1, 0}), twisted.add({0, 0, 0}, {1, 1, 0}, {0, 1, 0});
  twisted.add({1, 0, 0}, {2, 0, 0}, {2, 0.6f, 0.8f}),
      twisted.add({1, 0, 0}, {2, 0.6f, 0.8f}, {1, 0.6f, 0.8f});
  const EdgeIndex turned = twisted.index();
  const StraightEdges apart(turned);
  for (std::size_t i = 0; i < turned.edges().size(); ++i)
    EXPECT_EQ(apart.of(i).before + apart.of(i).after, 0.f);
}

}  // namespace
}  // namespace aureole
