// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/polygon_aperture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "aureole/optics/aperture/round_aperture.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;
using testing::scanline_transform;
using testing::wave_vectors;

const Ring kTriangle = {{-1, -0.5}, {2, 0.1}, {0.3, 1.7}};
const Ring kL = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2.5}, {0, 2.5}};

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
    EXPECT_LT(worst, 1e-10) << s.name;
  }
}

TEST(PolygonAperture, NeedlesLoseDigitsNotTheShape) {
  // Parallelograms: exactly a product of two sincs.
  const auto sinc = [](double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; };
  for (auto [aspect, tolerance] : {std::pair(1e-1, 1e-14), {1e-3, 1e-12}, {1e-5, 1e-10}}) {
    const PlanePoint e{1, 0.3}, f{-0.3 * aspect, aspect};
    const auto a = aperture({{{0, 0}, e, {e.x + f.x, e.y + f.y}, f}});
    for (double u = 1e-3; u < 200; u *= 1.2)
      for (double phi = 0; phi < 3.1; phi += 0.13) {
        const double qx = u * std::cos(phi), qy = u * std::sin(phi);
        const double along = 0.5 * (qx * e.x + qy * e.y), across = 0.5 * (qx * f.x + qy * f.y);
        const auto exact = std::polar(aspect * 1.09 * sinc(along) * sinc(across), -(along + across));
        ASSERT_LT(std::abs(a.transform(qx, qy) - exact), tolerance * a.area()) << aspect << " " << u;
      }
  }
}

TEST(PolygonAperture, AreaSymmetryAndSize) {
  for (const Shape& s : shapes()) {
    const auto a = aperture(s.rings);
    EXPECT_NEAR(std::abs(a.transform(0, 0) - a.area()), 0, 1e-13 * a.area());
    EXPECT_EQ(a.squared_area(), a.area());
    EXPECT_FALSE(a.is_circular());
    for (const PlanePoint& q : wave_vectors(1)) {
      EXPECT_LT(std::abs(a.transform(q.x, q.y) - std::conj(a.transform(-q.x, -q.y))), 1e-14 * a.area());
      EXPECT_LE(std::abs(a.transform(q.x, q.y)), (1 + 1e-14) * a.area());
    }
  }
  EXPECT_NEAR(aperture({kTriangle}).area(), 0.5 * (3 * 2.2 - 0.6 * 1.3), 1e-15);
  EXPECT_NEAR(aperture({kTriangle}).bounding_radius(), std::hypot(2, 0.1), 1e-15);
  EXPECT_NEAR(aperture({regular_ring(5, 2), regular_ring(7, 1)}).bounding_radius(), 2, 1e-15);
}

TEST(PolygonAperture, ManySidesAreACircle) {
  // A polygon of the same area differs by terms of the order sides^-4.
  const int n = 4096;
  const double radius = std::sqrt(2 * M_PI / (n * std::sin(2 * M_PI / n)));
  const auto polygon = aperture({regular_ring(n, radius)});
  const EllipseAperture circle(1, 1);
  for (double q : {0.0, 0.1, 0.99, 1.01, 3.8317, 10.0, 100.0})
    EXPECT_LT(std::abs(polygon.transform(0.6 * q, -0.8 * q) - circle.transform(0.6 * q, -0.8 * q)), 1e-10)
        << q;
}

TEST(PolygonAperture, ScalesAndMoves) {
  const PolygonRegion region = PolygonRegion::even_odd({kL});
  const PolygonAperture a(region), b(region.placed({1, 2}, 3e-6));
  for (const PlanePoint& q : wave_vectors(1)) {
    const auto expected = 9e-12 * a.transform(q.x, q.y) * std::polar(1.0, q.x + 2 * q.y);
    EXPECT_LT(std::abs(b.transform(q.x / 3e-6, q.y / 3e-6) - expected), 1e-14 * 9e-12 * a.area());
  }
}

/// (1/4 pi^2) integral of |F|^2 up to |q| = most.
double power(const ApertureShape& a, double most) {
  const int rings = int(most * 16), angles = 1024;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double q = most * (i + 0.5) / rings;
    double ring = 0;
    for (int k = 0; k < angles; ++k) {
      const double phi = M_PI * (k + 0.3) / angles;
      ring += std::norm(a.transform(q * std::cos(phi), q * std::sin(phi)));
    }
    sum += q * ring / angles;
  }
  return sum * most / rings / (2 * M_PI);
}

double perimeter(const std::vector<Ring>& rings) {
  double sum = 0;
  for (const Ring& r : rings)
    for (std::size_t i = 0; i < r.size(); ++i)
      sum += std::hypot(r[(i + 1) % r.size()].x - r[i].x, r[(i + 1) % r.size()].y - r[i].y);
  return sum;
}

TEST(PolygonAperture, ParsevalsTheorem) {
  // Beyond, the mean of |F|^2 over the directions is 2 perimeter/q^3 (Porod's law in the plane).
  const double most = 80;
  for (const std::vector<Ring>& rings :
       {std::vector<Ring>{kTriangle}, {kL}, {regular_ring(5, 1), regular_ring(3, 0.5)}}) {
    const auto a = aperture(rings);
    const double tail = perimeter(rings) / (M_PI * most);
    EXPECT_NEAR(power(a, most) + tail, a.area(), 3e-4 * a.area());
    EXPECT_GT(tail, 3e-3 * a.area());
  }
  const EllipseAperture ellipse(1, 0.6);
  EXPECT_NEAR(power(ellipse, most) + 5.105399773 / (M_PI * most), ellipse.area(), 3e-4 * ellipse.area());
  // The waves of the two edges interfere, which Porod's law leaves out.
  const AnnulusAperture ring(1, 0.7);
  EXPECT_NEAR(power(ring, most) + 2 * M_PI * 1.7 / (M_PI * most), ring.area(), 2e-3 * ring.area());
}

}  // namespace
}  // namespace aureole::optics
