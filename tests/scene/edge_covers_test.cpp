// SPDX-License-Identifier: Apache-2.0
// Sheets one behind another within a beam are one obstacle: their edges diffract light as those of the union in one plane, which is made
// of other triangles.
#include "aureole/scene/edge/edge_covers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "aureole/scene/edge/scene_diffraction.h"
#include "loading/load_text.h"
#include "scene/triangles.h"

namespace aureole {
namespace {

using test::Triangles;

/// A scene in um with light of .5 um and beams of 12.5 um, of rectangles of half widths (x, y) about a middle.
std::shared_ptr<const Scene> scene_of(const std::string& shapes) {
  return load_scene_from_string(
             R"(<scene version="3.0.0"><string name="length_unit" value="1um"/><integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/></integrator>
<sensor type="perspective"><film type="hdrfilm"><float name="wavelength_min" value="499"/><float name="wavelength_max" value="501"/>
<string name="response" value="uniform"/></film></sensor>
<emitter type="point"><point name="position" x="0" y="0" z="9000"/><spectrum name="intensity" value="1"/></emitter>)" +
                 shapes + "</scene>",
             "covers.xml")
      .scene;
}
std::string sheet(double x, double y, double half_x, double half_y, double z, double turned = 0) {
  char text[400];
  std::snprintf(text, sizeof text,
                R"(<shape type="rectangle"><transform name="to_world"><scale x="%.9g" y="%.9g"/>
<rotate z="1" angle="%.9g"/><translate x="%.9g" y="%.9g" z="%.9g"/></transform><bsdf type="diffuse"/></shape>)",
                half_x, half_y, turned, x, y, z);
  return text;
}
Wavelengths wavelengths_of(const Scene& scene) { return Wavelengths::at(scene.parts().context->grid, 500.f); }

/// The edge at a point of the xy-plane, with the position on it; nothing where no edge is there.
std::optional<EdgePoint> place_at(const Scene& scene, float x, float y) {
  for (const MeshEdge& edge : scene.diffraction()->edges().index().edges()) {
    Vec3 p{x, y, edge.a.z};
    if (edge.squared_distance(p) > 1e-6f) continue;
    const EdgeLine line(edge);
    return scene.diffraction()->edges().place_on(edge,
                                                 dot(Double3(p) - line.origin, line.direction) / line.length);
  }
  return {};
}

/// K and S of the same figure in one plane and in several, where each has its border and where it has none.
void compare(const Scene& flat, const Scene& deep, std::initializer_list<std::pair<float, float>> on_border,
             std::initializer_list<std::pair<float, float>> hidden_places) {
  const auto beams = flat.diffraction()->edges().beams(wavelengths_of(flat));
  for (const auto& [x, y] : on_border) {
    const auto one = place_at(flat, x, y), other = place_at(deep, x, y);
    ASSERT_TRUE(one && other) << x << " " << y;
    for (const Vec3& turn : {Vec3{0.05f, 0.02f, 0}, {-0.01f, 0.04f, 0}, {0.2f, 0, 0}, {0.003f, -0.3f, 0}}) {
      // Both directions about the normal, so that the sheets are seen along it.
      const Vec3 d_i = normalize(Vec3{0, 0, -1} - turn), d_o = normalize(Vec3{0, 0, -1} + turn);
      const Spectrum k = flat.diffraction()->edges().kernel(*one, d_i, d_o, beams, {0.3f, 0.6f}),
                     l = deep.diffraction()->edges().kernel(*other, d_i, d_o, beams, {0.3f, 0.6f});
      const float of_straight_edge = 0.5f / (39.5f * 4 * length_squared(turn));
      EXPECT_NEAR(k[0], l[0], 2e-4f * std::max(std::abs(k[0]), of_straight_edge)) << x << " " << y;
    }
    const Spectrum s = flat.diffraction()->edges().power(*one, {0, 0, -1}, beams).value(),
                   t = deep.diffraction()->edges().power(*other, {0, 0, -1}, beams).value();
    EXPECT_NEAR(s[0], t[0], 1e-4f * beams.sigma[0]) << x << " " << y;
  }
  for (const auto& [x, y] : hidden_places) {
    EXPECT_FALSE(place_at(flat, x, y)) << x << " " << y;
    const auto hidden = place_at(deep, x, y);
    ASSERT_TRUE(hidden) << x << " " << y;
    const Vec3 d_i = normalize(Vec3{0.05f, 0, -1}), d_o = normalize(Vec3{-0.05f, 0, -1});
    EXPECT_EQ(deep.diffraction()->edges().kernel(*hidden, d_i, d_o, beams, {})[0], 0.f) << x << " " << y;
    EXPECT_EQ(deep.diffraction()->edges().power(*hidden, {0, 0, -1}, beams).value()[0], 0.f) << x << " " << y;
  }
}

// Two crossed strips, with a small square behind the crossing that nobody sees; in beams of 12.5.
TEST(EdgeCovers, SheetsOneBehindAnotherAreOne) {
  const auto figure = [](double z1, double z2, double z3) {
    return scene_of(sheet(0, 0, 30, 6, z1) + sheet(2, 0, 5, 25, z2) + sheet(1, 1, 2, 3, z3));
  };
  const auto flat = figure(0, 0, 0), deep = figure(0, 12, -9);
  EXPECT_EQ(deep->diffraction()->edges().clusters().size(), 0u);
  compare(*flat, *deep,
          {{-20.f, 6.f}, {-20.f, -6.f}, {30.f, 1.f}, {2.f, 25.f}, {-3.f, 15.f}, {7.f, -20.f}, {8.7f, 6.f}},
          {{0.f, 6.f}, {0.f, -6.f}, {-3.f, 2.f}, {7.f, -1.f}, {3.f, 0.f}});
}

// Covers in a cluster, with a square that overlaps one strip, turned.
TEST(EdgeCovers, ClustersAreUnited) {
  const auto figure = [](double z1, double z2, double z3, double z4) {
    return scene_of(sheet(0, 0, 30, 6, z1) + sheet(2, 0, 5, 25, z2) + sheet(1, 1, 2, 3, z3) +
                    sheet(16, 7, 4, 4, z4, 20));
  };
  const auto flat = figure(0, 0, 0, 0), deep = figure(0, 1.5, -1, 0.5);
  ASSERT_EQ(flat->diffraction()->edges().clusters().size(), 1u);
  ASSERT_EQ(deep->diffraction()->edges().clusters().size(), 1u);
  compare(*flat, *deep,
          {{-20.f, 6.f}, {-20.f, -6.f}, {30.f, 1.f}, {2.f, 25.f}, {-3.f, 15.f}, {7.f, -20.f}, {8.7f, 6.f}},
          {{0.f, 6.f}, {0.f, -6.f}, {-3.f, 2.f}, {7.f, -1.f}, {3.f, 0.f}});
}

TEST(EdgeCovers, SheetsFarBehindAreOthers) {
  // More than 3 sigma apart.
  const auto scene = scene_of(sheet(0, 0, 30, 6, 0) + sheet(2, 0, 5, 25, 40));
  const auto x = place_at(*scene, 0, 6);
  ASSERT_TRUE(x);
  const auto beams = scene->diffraction()->edges().beams(wavelengths_of(*scene));
  EXPECT_GT(scene->diffraction()->edges().kernel(*x, normalize(Vec3{0, 0.05f, -1}),
                                                 normalize(Vec3{0, -0.05f, -1}), beams, {})[0],
            0.f);
}

// No edge of a convex body or of a flat sheet can be covered. A block on a table is covered where it stands.
TEST(EdgeCovers, AreLookedForWhereTheyCanBe) {
  const auto count = [](const std::shared_ptr<const Scene>& scene) {
    const SceneEdges& edges = scene->diffraction()->edges();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < edges.index().edges().size(); ++i) sum += edges.covers().may_be(i);
    return sum;
  };
  const std::string block =
      R"(<shape type="cube"><transform name="to_world"><scale value="8"/><rotate x="1" y="2" z="3" angle="40"/></transform></shape>)";
  EXPECT_EQ(count(scene_of(block)), 0u);
  EXPECT_EQ(count(scene_of(sheet(0, 0, 9, 9, 0))), 0u);
  EXPECT_EQ(count(scene_of(R"(<shape type="sphere"><float name="radius" value="8"/></shape>)")), 0u);
  // The four edges that stand on the table: not those that lie on it, nor those above 3 sigma, nor the table's own.
  EXPECT_EQ(
      count(scene_of(
          R"(<shape type="cube"><transform name="to_world"><scale value="30"/><translate z="30"/></transform></shape>)" +
          sheet(3, 0, 900, 900, 0))),
      4u);
}

// Whichever way faces are found: from lists, or in the tree where there are many.
TEST(EdgeCovers, ManySmallFacesAreOneLarge) {
  Triangles one, many;
  one.add({-10, -1, 0}, {10, -1, 0}, {10, 1, 0}), one.add({-10, -1, 0}, {10, 1, 0}, {-10, 1, 0});
  many = one;
  const auto add_square = [](Triangles& t, int cells) {
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        const auto at = [&](int x, int y) {
          return Vec3{3 + 4 * float(x) / float(cells), -2 + 4 * float(y) / float(cells), 1};
        };
        t.add(at(i, j), at(i + 1, j), at(i + 1, j + 1)), t.add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
  };
  add_square(one, 1), add_square(many, 16);
  for (const Triangles* mesh : {&one, &many}) {
    const TriangleSet set{mesh->positions, mesh->triangles};
    const EdgeIndex index = mesh->index();
    const EdgeCovers covers(index, {}, FaceTree({&set, 1}), 2);
    for (const Vec3& d : {Vec3{0, 0, -1}, normalize(Vec3{0.4f, 0.1f, -1}), normalize(Vec3{0.4f, 0.1f, 1})}) {
      // The square is seen from the plane of the strip where the light has moved it.
      const float moved = -d.x / d.z;
      int long_ones = 0;
      for (std::size_t i = 0; i < index.edges().size(); ++i) {
        const MeshEdge& edge = index.edges()[i];
        if (std::abs(edge.b.x - edge.a.x) < 19) continue;
        ++long_ones;
        ASSERT_TRUE(covers.may_be(i));
        const auto open = covers.open(edge, i, d, 2);
        ASSERT_EQ(open.size(), 2u);
        const bool turned = edge.b.x < edge.a.x;
        const auto x_of = [&](double t) { return edge.a.x + (edge.b.x - edge.a.x) * float(t); };
        EXPECT_NEAR(x_of(open[0].to), (turned ? 7 : 3) + moved, 1e-4);
        EXPECT_NEAR(x_of(open[1].from), (turned ? 3 : 7) + moved, 1e-4);
        // Beside it, and where less of the depth counts.
        EXPECT_EQ(covers.open(edge, i, normalize(Vec3{0, 0.9f, -0.1f}), 2).size(), 1u);
        EXPECT_EQ(covers.open(edge, i, d, 0.9f).size(), 1u);
      }
      EXPECT_EQ(long_ones, 2);
    }
  }
}

}  // namespace
}  // namespace aureole
