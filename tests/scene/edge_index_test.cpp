// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_index.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "aureole/scene/edge/edge_distance.h"

namespace aureole {
namespace {

struct Triangles {
  std::vector<Vec3> positions;
  std::vector<TriangleIndices> triangles;
  operator TriangleSet() const { return {positions, triangles}; }
};

/// Normals outside, every side with vertices of its own, as a file with normals has them.
Triangles cube() {
  Triangles t;
  for (int axis = 0; axis < 3; ++axis)
    for (float side : {-1.f, 1.f}) {
      const auto first = std::uint32_t(t.positions.size());
      for (auto [u, v] : {std::pair(-1.f, -1.f), {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}}) {
        Vec3 p;
        p[axis] = side, p[(axis + 1) % 3] = u * side, p[(axis + 2) % 3] = v;
        t.positions.push_back(p);
      }
      t.triangles.push_back({first, first + 1, first + 2});
      t.triangles.push_back({first, first + 2, first + 3});
    }
  return t;
}

std::vector<MeshEdge> edges_of(std::vector<TriangleSet> sets) { return find_mesh_edges(sets); }

TEST(MeshEdges, OfACubeAreItsTwelve) {
  const Triangles box = cube();
  const auto edges = edges_of({box});
  ASSERT_EQ(edges.size(), 12u);
  for (const MeshEdge& e : edges) {
    EXPECT_FALSE(e.is_boundary);
    EXPECT_FALSE(e.is_concave);
    EXPECT_NEAR(dot(e.n0, e.n1), 0, 1e-6);
    // The face lies to the left of its edge, seen from outside.
    EXPECT_GT(dot(cross(e.b - e.a, e.n0), 0.5f * (e.a + e.b)), 0);
  }
  const auto outline = [&](const Vec3& d) {
    return std::count_if(edges.begin(), edges.end(), [&](const MeshEdge& e) { return e.is_outline(d); });
  };
  EXPECT_EQ(outline(normalize(Vec3{1, 2, 3})), 6);
  EXPECT_EQ(outline(normalize(Vec3{1, 2, 0.01f})), 6);
}

TEST(MeshEdges, SeamsAreNoneAndFoldsBetweenMeshesAre) {
  const Triangles floor{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Triangles beside{{{1, 0, -0.f}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(edges_of({floor}).size(), 4u);
  EXPECT_EQ(edges_of({floor, beside}).size(), 6u);
  const Triangles wall{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const Triangles wall_turned{wall.positions, {{2, 1, 0}, {3, 2, 0}}};
  for (const Triangles& w : {wall, wall_turned}) {
    const auto edges = edges_of({floor, w});
    ASSERT_EQ(edges.size(), 7u);
    const auto fold =
        std::find_if(edges.begin(), edges.end(), [](const MeshEdge& e) { return !e.is_boundary; });
    ASSERT_NE(fold, edges.end());
    EXPECT_TRUE(fold->is_concave);
    EXPECT_EQ(fold->face0.set, 0u);
    EXPECT_EQ(fold->face1.set, 1u);
    // Normals on one side of the surface, however the wall is wound.
    EXPECT_NEAR(dot(fold->n0, Vec3{0, 0, 1}), 1, 1e-6);
    EXPECT_NEAR(dot(fold->n1, Vec3{-1, 0, 0}), 1, 1e-6);
  }
  // A third face on the other side of the fold leaves no way past that edge; triangles and edges of no extent are left out.
  const Triangles flag{{{1, 0, 0}, {1, 1, 0}, {1.5f, 0.5f, -1}, {1, 0.5f, 0}},
                       {{0, 1, 2}, {0, 1, 3}, {0, 0, 1}}};
  const auto edges = edges_of({floor, wall, flag});
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](const MeshEdge& e) { return e.is_boundary; }),
            6 + 2);
  EXPECT_EQ(edges.size(), 8u);
  EXPECT_TRUE(edges_of({}).empty());
}

// Light passes an edge where all of its faces, seen along the light, lie on one side.
TEST(MeshEdges, OfManyFacesAreOutlinesWhereAllLieOnOneSide) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> even(-1, 1);
  int outlines = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int faces = 1 + trial % 5;
    const auto point = [&] { return Vec3{even(engine), even(engine), even(engine)}; };
    const Vec3 a = point(), b = point();
    Triangles t{{a, b}, {}};
    for (int i = 0; i < faces; ++i) {
      t.positions.push_back(point());
      const auto third = std::uint32_t(t.positions.size() - 1);
      t.triangles.push_back(engine() % 2 ? TriangleIndices{0, 1, third} : TriangleIndices{third, 1, 0});
    }
    const auto edges = edges_of({t});
    const auto is_common = [&](const MeshEdge& e) {
      return (e.a == a && e.b == b) || (e.a == b && e.b == a);
    };
    ASSERT_LE(std::count_if(edges.begin(), edges.end(), is_common), 1);
    const auto own = std::find_if(edges.begin(), edges.end(), is_common);
    for (int k = 0; k < 20; ++k) {
      const Vec3 d = normalize(point()), side = cross(d, b - a);
      int left = 0;
      for (int i = 0; i < faces; ++i) left += dot(t.positions[std::size_t(2 + i)] - a, side) > 0;
      const bool passes = left == 0 || left == faces;
      EXPECT_EQ(own != edges.end() && own->is_outline(d), passes) << trial;
      outlines += passes && faces > 2;
      if (!passes || own == edges.end()) continue;
      // The obstacle is on the left of an edge where its first face is lit, as `kernel` has it.
      const bool is_left = (dot(own->n0, d) < 0) == (own->a == a);
      if (std::abs(dot(own->n0, d)) > 1e-3f) {
        EXPECT_EQ(is_left, dot(side, t.positions[2] - a) < 0);
      }
    }
  }
  EXPECT_GT(outlines, 500);
}

// The edges of sheets that overlap in one plane are the border of their union, counted by squares.
TEST(MeshEdges, OfOverlappingSheetsAreTheBorderOfTheirUnion) {
  std::mt19937 engine(3);
  const Vec3 x = normalize(Vec3{1, 0.3f, -0.2f}), y = normalize(cross(Vec3{0.1f, 1, 0.4f}, x)),
             origin{20, -7, 3};
  for (int trial = 0; trial < 60; ++trial) {
    bool filled[14][14] = {};
    std::vector<Triangles> sheets(std::size_t(1 + trial % 7));
    for (Triangles& sheet : sheets) {
      const int x0 = 1 + int(engine() % 8), y0 = 1 + int(engine() % 8), x1 = x0 + 1 + int(engine() % 4),
                y1 = y0 + 1 + int(engine() % 4);
      for (int i = x0; i < x1; ++i)
        for (int j = y0; j < y1; ++j) filled[i][j] = true;
      for (const auto& [u, v] : {std::pair(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
        sheet.positions.push_back(origin + x * float(u) + y * float(v));
      sheet.triangles = engine() % 2 ? std::vector<TriangleIndices>{{0, 1, 2}, {0, 2, 3}}
                                     : std::vector<TriangleIndices>{{3, 1, 0}, {2, 1, 3}};
    }
    double border = 0;
    for (int i = 1; i < 14; ++i)
      for (int j = 1; j < 14; ++j)
        border += double(filled[i][j] != filled[i - 1][j]) + double(filled[i][j] != filled[i][j - 1]);
    double found = 0;
    for (const MeshEdge& e : edges_of({sheets.begin(), sheets.end()})) {
      EXPECT_TRUE(e.is_boundary);
      found += length(e.b - e.a);
    }
    EXPECT_NEAR(found, border, 1e-3) << trial;
  }
}

// A face far away has corners that may be off by more than the others' sizes, and corners nearer to one another than that make none.
TEST(MeshEdges, FacesFarAwayLeaveOthersAsTheyAre) {
  Triangles squares;
  const auto add = [](Triangles& to, const Vec3& corner, float size) {
    const auto first = std::uint32_t(to.positions.size());
    for (const auto& [u, v] : {std::pair(0.f, 0.f), {size, 0.f}, {size, size}, {0.f, size}})
      to.positions.push_back(corner + Vec3{u, v, 0});
    to.triangles.push_back({first, first + 1, first + 2});
    to.triangles.push_back({first, first + 2, first + 3});
  };
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) add(squares, {float(2 * i), float(2 * j), 0}, 1);
  const auto seconds = [](const std::vector<TriangleSet>& sets, std::size_t edges) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(edges_of(sets).size(), edges);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double alone = seconds({squares}, 4 * 3600);
  Triangles far;
  add(far, {-3e8f, 0, 0}, 1e6f);
  for (int i = 0; i < 3600; ++i) add(far, {-3e8f, 0, float(i)}, 100);  // within what floats are off there
  EXPECT_LT(seconds({squares, far}, 4 * 3600 + 4), 10 * alone + 0.1);
}

// A closed body, the top of which is as small as its corners may be off: that face is none, and leaves no borders behind.
TEST(MeshEdges, FacesWithoutExtentLeaveNoBorders) {
  const Vec3 at{1e6f, 0, 0};
  Triangles body;
  for (int i = 0; i < 3; ++i) {
    const float a = 2.0944f * float(i);
    body.positions.push_back(at + Vec3{200 * std::cos(a), 200 * std::sin(a), 0});
  }
  for (const Vec3& p : {Vec3{0, 0, 300}, {0, 0.1f, 300}, {0, 0, 300.1f}}) body.positions.push_back(at + p);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t j = (i + 1) % 3;
    body.triangles.push_back({i, j, 3 + j});
    body.triangles.push_back({i, 3 + j, 3 + i});
  }
  body.triangles.push_back({2, 1, 0});
  body.triangles.push_back({3, 4, 5});
  int creases = 0;
  for (const MeshEdge& e : edges_of({body})) {
    EXPECT_FALSE(e.is_boundary) << e.a.z << " " << e.b.z;
    ++creases;
  }
  EXPECT_GE(creases, 6);
}

/// Brute force: points along the segment.
bool near(const Vec3& a, const Vec3& b, const Beam& beam, float radius) {
  for (int i = 0; i <= 2000; ++i) {
    const Vec3 v = a + (b - a) * (float(i) / 2000) - beam.o;
    const float t = dot(v, beam.d);
    if (t >= beam.begin && t <= beam.end && length_squared(v - beam.d * t) <= radius * radius) return true;
  }
  return false;
}

struct Random {
  std::mt19937 engine{9};
  float operator()() { return std::uniform_real_distribution<float>(-1, 1)(engine); }
  Vec3 point() { return {(*this)(), (*this)(), (*this)()}; }
};

TEST(EdgeIndex, FindsWhatBruteForceFinds) {
  Random random;
  Triangles soup;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = random.point();
    const float size = i % 10 ? 0.1f : 1.5f;
    for (int j = 0; j < 3; ++j) soup.positions.push_back(p + size * random.point());
    const auto n = std::uint32_t(3 * i);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const TriangleSet set = soup;
  const EdgeIndex index(std::span(&set, 1));
  EXPECT_EQ(index.edges().size(), 1200u);
  int found_edges = 0, found_faces = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Beam beam{random.point(), normalize(random.point()), 0.02f + 0.2f * std::abs(random()), -0.4f, 0.3f};
    if (trial % 4 == 0) beam.d = {0, 0, trial % 8 ? 1.f : -1.f};
    std::set<const void*> edges, faces;
    index.visit_edges(beam, [&](const MeshEdge& e) { EXPECT_TRUE(edges.insert(&e).second); });
    index.visit_faces(beam, [&](const EdgeIndex::Face& f) { EXPECT_TRUE(faces.insert(&f).second); });
    for (const MeshEdge& e : index.edges()) {
      const bool found = edges.count(&e) > 0;
      EXPECT_TRUE(found || !near(e.a, e.b, beam, 0.99f * beam.radius));
      EXPECT_TRUE(!found || near(e.a, e.b, beam, beam.radius + 0.002f));
    }
    for (const EdgeIndex::Face& f : index.faces()) {
      // Chords from a corner to the opposite side.
      bool inside = false, well_inside = false;
      for (int i = 0; i <= 60; ++i) {
        const Vec3 q = f.p[1] + (f.p[2] - f.p[1]) * (float(i) / 60);
        for (int j = 0; j <= 60; ++j) {
          const Vec3 v = f.p[0] + (q - f.p[0]) * (float(j) / 60) - beam.o;
          const float t = dot(v, beam.d), r2 = length_squared(v - beam.d * t);
          well_inside |= t >= beam.begin && t <= beam.end && r2 <= 0.9f * beam.radius * beam.radius;
          inside |=
              t >= beam.begin - 0.05f && t <= beam.end + 0.05f && r2 <= std::pow(beam.radius + 0.06f, 2);
        }
      }
      const bool found = faces.count(&f) > 0;
      EXPECT_TRUE(found || !well_inside);
      EXPECT_TRUE(!found || inside);
    }
    found_edges += int(edges.size()), found_faces += int(faces.size());
  }
  EXPECT_GT(found_edges, 200);
  EXPECT_GT(found_faces, 200);
}

/// A sphere of 2 n^2 triangles.
Triangles sphere(int n) {
  Triangles t;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < n; ++j) {
      const double theta = M_PI * i / n, phi = 2 * M_PI * j / n;
      t.positions.push_back({float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                             float(std::cos(theta))});
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto at = [&](int a, int b) { return std::uint32_t(a * n + b % n); };
      t.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return t;
}

// The outline of a sphere in the whole beam, and what the cones of normals save: every edge is a fold, few are outlines.
TEST(EdgeIndex, OutlinesOfASphere) {
  const Triangles ball = sphere(100);
  const TriangleSet set = ball;
  const EdgeIndex index(std::span(&set, 1));
  EXPECT_GE(index.edges().size(), 19900u);
  for (const Vec3& d : {normalize(Vec3{1, 0.3f, 0.2f}), Vec3{0, 0, 1}}) {
    double length_of_outline = 0;
    std::size_t count = 0, expected = 0;
    index.visit_edges({{0, 0, 0}, d, 3, -3, 3},
                      [&](const MeshEdge& e) { length_of_outline += length(e.b - e.a), ++count; });
    for (const MeshEdge& e : index.edges()) expected += e.is_outline(d);
    EXPECT_EQ(count, expected);
    EXPECT_LT(count, 1000u);
    EXPECT_GT(length_of_outline, 6.2);
  }
}

TEST(EdgeDistance, OfEdgesFarFromTheOrigin) {
  // Coordinates are rounded to half a metre.
  const Vec3 o{5e6f, 5.4e6f, 0};
  Triangles square;
  square.positions = {o, o + Vec3{20, 0, 0}, o + Vec3{20, 20, 0}, o + Vec3{0, 20, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TriangleSet set = square;
  const EdgeIndex index(std::span(&set, 1));
  ASSERT_FALSE(index.edges().empty());
  const EdgeDistance distance(index, 0);
  EXPECT_EQ(distance.at_least(o + Vec3{10, 0, 0}), 0);
  EXPECT_LE(distance.at_least(o + Vec3{10, 10, 0}), 10);
}

TEST(EdgeDistance, IsNeverAboveTheDistanceOfTheNearestEdge) {
  Random random;
  Triangles soup;
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = random.point();
    for (int j = 0; j < 3; ++j) soup.positions.push_back(p + (i % 10 ? 0.1f : 1.5f) * random.point());
    const auto n = std::uint32_t(3 * i);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const TriangleSet set = soup;
  const EdgeIndex index(std::span(&set, 1));
  const EdgeDistance distance(index, 0), with_margin(index, 0.2f);
  double told = 0, all = 0;
  int within = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Vec3 p = (trial % 3 ? 1.f : 4.f) * random.point();  // some outside
    // By fine steps along the edges.
    double nearest = INFINITY;
    for (const MeshEdge& e : index.edges())
      for (int i = 0; i <= 500; ++i)
        nearest = std::min(nearest, double(length(p - (e.a + (e.b - e.a) * (float(i) / 500)))));
    EXPECT_LE(distance.at_least(p), nearest);
    EXPECT_LE(with_margin.at_least(p), nearest);
    const float reach = 0.05f + 0.3f * float(trial % 7);
    if (std::abs(nearest - reach) > 0.01) {
      EXPECT_EQ(index.has_edge_within(p, reach), nearest < reach);
      within += nearest < reach;
    }
    if (trial % 3) told += distance.at_least(p), all += nearest;
  }
  EXPECT_GT(told, 0.3 * all);
  EXPECT_GT(within, 60);
  EXPECT_EQ(EdgeDistance(EdgeIndex(), 0.1f).at_least({}), kInfinity);
}

TEST(EdgeDistance, NoEdgeIsWithinTheMarginOfWhatIsFree) {
  Random random;
  Triangles soup;
  for (int i = 0; i < 12; ++i) {
    const Vec3 p = random.point();
    for (int j = 0; j < 3; ++j) soup.positions.push_back(p + 0.3f * random.point());
    const auto n = std::uint32_t(3 * i);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const TriangleSet set = soup;
  const EdgeIndex index(std::span(&set, 1));
  const float margin = 0.15f;
  const EdgeDistance distance(index, margin);
  int all = 0, some = 0, none = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Vec3 o = (trial % 2 ? 1.f : 3.f) * random.point();
    const Vec3 d = trial % 8 == 7 ? Vec3{0, -1, 0} : normalize(random.point());
    const float length = trial % 5 == 4 ? kInfinity : 2.5f, free = distance.free_along(o, d, length);
    EXPECT_GE(free, 0);
    EXPECT_LE(free, length);
    const float until = std::min(free, 12.f);
    for (int i = 0; free > 0 && i < 200; ++i)
      EXPECT_FALSE(index.has_edge_within(o + d * (until * float(i) / 200), margin - 0.002f)) << trial;
    (free == length ? all : free > 0 ? some : none)++;
  }
  EXPECT_GT(all, 200);
  EXPECT_GT(some, 200);
  EXPECT_GT(none, 50);
  EXPECT_EQ(EdgeDistance(EdgeIndex(), 0.1f).free_along({}, {0, 0, 1}, kInfinity), kInfinity);
  // From far away, where a cell is less than the rounding of distances.
  for (const float far : {1e3f, 1e5f, 1e7f}) {
    int met = 0;
    for (int trial = 0; trial < 300; ++trial) {
      const Vec3 d = normalize(random.point()),
                 at = index.edges()[std::size_t(trial) % index.edges().size()].a;
      const float free = distance.free_along(at - d * far, d, kInfinity);
      met += free < kInfinity;
      if (free < kInfinity) {
        EXPECT_NEAR(free, far, 4 + 1e-6f * far);
      }
    }
    EXPECT_GT(met, far < 1e6f ? 290 : 0) << far;
  }
}

TEST(EdgeIndex, OfNothingFindsNothing) {
  const EdgeIndex index;
  index.visit_edges({{0, 0, 0}, {0, 0, 1}, 1, 0, 1}, [](const MeshEdge&) { FAIL(); });
  index.visit_faces({{0, 0, 0}, {0, 0, 1}, 1, 0, 1}, [](const EdgeIndex::Face&) { FAIL(); });
  EXPECT_EQ(EdgeIndex(std::span<const TriangleSet>()).memory_bytes(), 0u);
}

// Items at one place, which no plane divides.
TEST(BeamTree, EqualBoxes) {
  std::vector<Bounds3> boxes(1000);
  for (Bounds3& b : boxes) b.extend(Vec3{1, 1, 1});
  int count = 0;
  BeamTree(boxes).visit({{1, 1, 0}, {0, 0, 1}, 0.1f, 0, 2}, [&](std::uint32_t) { ++count; });
  EXPECT_EQ(count, 1000);
}

// Along an axis the ray enters the slabs of what lies beside it nowhere, or at infinity.
TEST(BeamTree, BeamsAlongAnAxisVisitWhatTheyMeet) {
  std::vector<Bounds3> boxes;
  for (int i = 0; i < 4096; ++i) {
    const Vec3 corner{float(i % 16), float(i / 16 % 16), float(i / 256)};
    boxes.push_back({corner, corner + Vec3{0.5f, 0.5f, 0.5f}});
  }
  const BeamTree tree(boxes);
  for (const Vec3& d : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}}) {
    const Vec3 across{d.x != 0 ? 0.f : 3.2f, d.y != 0 ? 0.f : 3.2f, d.z != 0 ? 0.f : 3.2f};
    const float sign = d.x + d.y + d.z;  // the beam goes from 4.1 to 9.1, or back
    int visited = 0;
    tree.visit({across + d * (sign > 0 ? 4.1f : -9.1f), d, 0.01f, 0, 5}, [&](std::uint32_t) { ++visited; });
    EXPECT_GE(visited, 4);
    EXPECT_LE(visited, 64);
  }
}

}  // namespace
}  // namespace aureole
