// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/polygon_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;

Ring square(double x, double y, double side) {
  return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}

Ring reversed(Ring r) {
  std::reverse(r.begin(), r.end());
  return r;
}

double signed_area(const Ring& r) {
  double a = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const PlanePoint p = r[i], q = r[(i + 1) % r.size()];
    a += 0.5 * (p.x * q.y - p.y * q.x);
  }
  return a;
}

TEST(PolygonRegion, OrientationOfTheInputDoesNotMatter) {
  for (const Ring& outer : {square(0, 0, 4), reversed(square(0, 0, 4))})
    for (const Ring& hole : {square(1, 1, 1), reversed(square(1, 1, 1))}) {
      const PolygonRegion r = PolygonRegion::even_odd({hole, outer});
      EXPECT_NEAR(r.area(), 15, 1e-14);
      ASSERT_EQ(r.rings().size(), 2u);
      int outers = 0;
      for (const Ring& ring : r.rings()) outers += signed_area(ring) > 0;
      EXPECT_EQ(outers, 1);
      EXPECT_NEAR(r.centroid().x, (16 * 2 - 1.5) / 15, 1e-14);
      EXPECT_NEAR(r.centroid().y, (16 * 2 - 1.5) / 15, 1e-14);
    }
  EXPECT_NEAR(PolygonRegion::even_odd({reversed(square(5, 5, 2))}).area(), 4, 1e-15);
}

TEST(PolygonRegion, EvenOdd) {
  const auto area = [](std::vector<Ring> rings) { return PolygonRegion::even_odd(std::move(rings)).area(); };
  EXPECT_NEAR(area({square(0, 0, 4), square(1, 1, 2), square(1.5, 1.5, 1)}), 16 - 4 + 1, 1e-13);
  EXPECT_NEAR(area({square(0, 0, 2), square(1, 1, 2)}), 4 + 4 - 2, 1e-13);  // overlap
  EXPECT_NEAR(area({square(0, 0, 1), square(1, 0, 1)}), 2, 1e-13);          // a common edge
  EXPECT_NEAR(area({square(0, 0, 1), square(1, 1, 1)}), 2, 1e-13);          // a common corner
  EXPECT_NEAR(area({square(0, 0, 2), square(0, 0, 1)}), 3, 1e-13);          // a hole at the border
  EXPECT_NEAR(area({square(0, 0, 1), square(3e4, 0, 1)}), 2, 1e-11);
}

TEST(PolygonRegion, EvenOddOfRingsThatLieOnOneAnother) {
  const auto expect = [](const std::vector<Ring>& rings) {
    std::vector<double> heights;  // of crossings
    for (const Ring& r : rings)
      for (const Ring& other : rings)
        for (std::size_t i = 0; i < r.size(); ++i)
          for (std::size_t k = 0; k < other.size(); ++k) {
            const PlanePoint a = r[i], b = r[(i + 1) % r.size()], c = other[k],
                             d = other[(k + 1) % other.size()];
            const double area = (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
            const double t = ((c.x - a.x) * (d.y - c.y) - (c.y - a.y) * (d.x - c.x)) / area;
            if (std::abs(area) > 1e-12 && t >= 0 && t <= 1) heights.push_back(a.y + t * (b.y - a.y));
          }
    double area = 0;
    try {
      area = PolygonRegion::even_odd(rings).area();
    } catch (const std::domain_error& e) {
      // Rounding to the lattice made a ring touch itself.
      EXPECT_NE(std::string(e.what()).find("ring "), std::string::npos) << e.what();
      return;
    }
    EXPECT_NEAR(area, testing::scanline_transform(rings, 0, 0, heights).real(), 1e-10);
  };
  // A vertex that lies on an edge up to rounding; then shapes for which Clipper alone returns a wrong union.
  expect({{{0.5, 0}, {-0.5, -0.25}, {-0.25, -1.25}, {0.75, -1}},
          {{1, -0.5}, {0.25, 0.25}, {-1, 0}, {-1.25, -1.25}, {-0.25, -2}, {0.75, -1.75}}});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    std::vector<Ring> rings;
    const int lattice = 3 + i % 2;
    for (int k = 0; k < 2 + i % 4; ++k) {
      rings.push_back(regular_ring(3 + (i + k) % 6, 0.3 + std::abs(unit(random)), unit(random),
                                   {unit(random), unit(random)}));
      for (PlanePoint& p : rings.back())
        p = {std::round(p.x * lattice) / lattice, std::round(p.y * lattice) / lattice};
    }
    expect(rings);
  }
}

TEST(PolygonRegion, RepeatedAndCollinearVertices) {
  const Ring r = {{0, 0}, {1, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}};
  const PolygonRegion region = PolygonRegion::even_odd({r});
  EXPECT_NEAR(region.area(), 4, 1e-15);
  EXPECT_EQ(region.rings()[0].size(), 5u);
}

TEST(PolygonRegion, PlacedAndBounds) {
  const PolygonRegion r = PolygonRegion::even_odd({square(100, 200, 4)}).placed({102, 202}, 0.5);
  EXPECT_EQ(r.lower().x, -1);
  EXPECT_EQ(r.upper().y, 1);
  EXPECT_NEAR(r.centroid().x, 0, 1e-15);
  EXPECT_NEAR(r.area(), 4, 1e-15);
}

TEST(PolygonRegion, Errors) {
  const auto message = [](std::vector<Ring> rings) -> std::string {
    try {
      PolygonRegion::even_odd(std::move(rings));
    } catch (const std::domain_error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(message({}), "has no vertices");
  EXPECT_EQ(message({{{0, 0}, {1, NAN}, {1, 1}}}), "a coordinate is not a number below 1e100");
  EXPECT_EQ(message({{{0, 0}, {1e300, 0}, {1, 1}}}), "a coordinate is not a number below 1e100");
  EXPECT_EQ(message({{{1, 1}, {1, 1}, {1, 1}}}), "all its vertices are in one place");
  EXPECT_EQ(message({square(0, 0, 1), {{0, 0}, {1, 1}, {0, 0}}}),
            "ring 2 has fewer than 3 different vertices");
  EXPECT_EQ(
      message({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}),
      "ring 1 touches or crosses itself: edge 1 from (0, 0) to (2, 2) meets edge 3 from (2, 0) to (0, 2)");
  // A path that comes back to a vertex, one that runs back along an edge, and one that touches an edge.
  EXPECT_NE(message({{{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}}).find("touches or crosses"),
            std::string::npos);
  EXPECT_NE(message({{{0, 0}, {2, 0}, {2, 2}, {3, 3}, {2, 2}, {0, 2}}}).find("touches or crosses"),
            std::string::npos);
  EXPECT_NE(message({{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}}).find("touches or crosses"),
            std::string::npos);
  EXPECT_NE(message({{{0, 0}, {1, 0}, {2, 0}}}).find("touches or crosses"), std::string::npos);
  EXPECT_EQ(message({square(0, 0, 1), square(0, 0, 1)}), "has no area");
  EXPECT_EQ(message({{{0, 0}, {1, 0}, {1, 1e-11}}}), "has no area");
  EXPECT_EQ(message({regular_ring(10001, 1)}), "has 10001 vertices; the limit is 10000");
  EXPECT_EQ(message({regular_ring(9000, 1)}), "no error");
  // Two combs whose teeth cross.
  Ring across, down;
  for (int i = 0; i < 240; ++i) {
    across.push_back({i % 4 == 0 || i % 4 == 3 ? 0.0 : 300.0, i + 30.0});
    down.push_back({i + 30.0, i % 4 == 0 || i % 4 == 3 ? 0.0 : 300.0});
  }
  across.insert(across.end(), {{-10, 280}, {-10, 5}});
  down.insert(down.end(), {{280, -10}, {5, -10}});
  EXPECT_EQ(message({across, down}), "its rings cross each other more than 10000 times");
}

}  // namespace
}  // namespace aureole::optics
