// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/polygon_aperture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "aureole/optics/round_aperture.h"
#include "optics/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;
using testing::scanline_transform;

const Ring kTriangle = {{-1, -0.5}, {2, 0.1}, {0.3, 1.7}};
const Ring kL = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2.5}, {0, 2.5}};
const Ring kNeedle = {{0, 0}, {1, 0.002}, {1, 0.003}, {0, 0.001}};

PolygonAperture aperture(std::vector<Ring> rings) {
  return PolygonAperture(PolygonRegion::even_odd(std::move(rings)));
}

struct Shape {
  const char* name;
  std::vector<Ring> rings;
  std::vector<double> crossing_heights = {};
};

std::vector<Shape> shapes() {
  Ring star;
  for (int i = 0; i < 14; ++i)
    star.push_back({std::cos(i * M_PI / 7) * (i % 2 ? 0.3 : 1), std::sin(i * M_PI / 7) * (i % 2 ? 0.3 : 1)});
  return {{"triangle", {kTriangle}},
          {"L", {kL}},
          {"star", {star}},
          {"hexagon", {regular_ring(6, 1)}},
          {"fine circle", {regular_ring(301, 0.7, 0.1, {2, -1})}},
          {"hole", {regular_ring(5, 2), regular_ring(7, 1, 0.3)}},
          {"island in a hole",
           {regular_ring(9, 3), regular_ring(4, 2), regular_ring(3, 1), {{-5, 4}, {-4, 4}, {-4, 5}}}},
          {"overlap", {{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}}},
          {"crossing",
           {{{0, 0}, {4, 0}, {2, 3}}, {{0, 2}, {2, -1}, {4, 2}}},
           {0, 2, 2.0 - 10.0 / 9, 8.0 / 9, 2.0 / 3, 4.0 / 3, 1, 0.5, 1.2}},
          {"far away", {regular_ring(6, 1, 0.2, {300, -500})}}};
}

/// Directions and lengths of q relative to the shape's size, with edges' normals among them.
std::vector<PlanePoint> wave_vectors(double size) {
  std::vector<PlanePoint> all = {{0, 0}};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit;
  for (double u : {1e-12, 1e-6, 1e-3, 0.03, 0.3, 0.9, 0.999, 1.001, 1.1, 3.0, 10.0, 40.0}) {
    for (double phi : {0.0, 0.5 * M_PI, M_PI / 6})
      all.push_back({u * std::cos(phi) / size, u * std::sin(phi) / size});
    const double phi = 2 * M_PI * unit(random);
    all.push_back({u * std::cos(phi) / size, u * std::sin(phi) / size});
  }
  return all;
}

TEST(PolygonAperture, IsTheIntegralOverScanLines) {
  for (const Shape& s : shapes()) {
    const PolygonRegion region = PolygonRegion::even_odd(s.rings);
    const PolygonAperture a(region);
    const double size =
        0.5 * std::hypot(region.upper().x - region.lower().x, region.upper().y - region.lower().y);
    double worst = 0;
    for (const PlanePoint& q : wave_vectors(size)) {
      const auto exact = scanline_transform(s.rings, q.x, q.y, s.crossing_heights);
      worst = std::max(worst, std::abs(a.transform(q.x, q.y) - exact) / a.area());
    }
    RecordProperty(s.name, std::to_string(worst));
    EXPECT_LT(worst, 1e-10) << s.name;
  }
}


}  // namespace
}  // namespace aureole::optics
