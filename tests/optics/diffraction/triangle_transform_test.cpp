// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/triangle_transform.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <random>

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
using Rule = boost::math::quadrature::gauss<double, 20>;

/// Integral of f over a triangle by Gauss's rule on cells of its square (u, v) -> corner 0 + u (side + v (opposite side)).
template <class F>
Complex over_triangle(const LinearTriangle& t, int cells, const F& f) {
  const auto& [p0, p1, p2] = t.corner;
  Complex sum = 0;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
        for (std::size_t l = 0; l < Rule::abscissa().size(); ++l)
          for (int signs = 0; signs < 4; ++signs) {
            const double u = (i + 0.5 + (signs & 1 ? 0.5 : -0.5) * Rule::abscissa()[k]) / cells,
                         v = (j + 0.5 + (signs & 2 ? 0.5 : -0.5) * Rule::abscissa()[l]) / cells;
            const double g1 = u * (1 - v), g2 = u * v, g0 = 1 - u;
            const PlanePoint x{g0 * p0.x + g1 * p1.x + g2 * p2.x, g0 * p0.y + g1 * p1.y + g2 * p2.y};
            sum += Rule::weights()[k] * Rule::weights()[l] * 0.25 / (cells * cells) * 2 * t.area() * u *
                   f(x, g0 * t.value[0] + g1 * t.value[1] + g2 * t.value[2]);
          }
  return sum;
}

Complex quadrature(const LinearTriangle& t, PlanePoint q) {
  double widest = 0;
  for (int j = 0; j < 3; ++j) {
    const PlanePoint a = t.corner[j], b = t.corner[(j + 1) % 3];
    widest = std::max(widest, std::abs(q.x * (b.x - a.x) + q.y * (b.y - a.y)));
  }
  return over_triangle(t, 1 + int(widest / 10), [&](PlanePoint x, Complex value) {
    return value * std::polar(1.0, -(q.x * x.x + q.y * x.y));
  });
}

const LinearTriangle kTriangles[] = {
    {{{{0, 0}, {1, 0}, {0, 1}}}, {1, 1, 1}},
    {{{{-1, -0.5}, {2, 0.1}, {0.3, 1.7}}}, {Complex(1, 0.3), Complex(-0.4, 2), 0.7}},
    {{{{0, 0}, {0, 1}, {1, 0}}}, {3, Complex(0, 1), -2}},           // clockwise
    {{{{3, 1}, {4, 1.01}, {5, 1.0}}}, {1, Complex(0.2, -1), 0.5}},  // a needle
};

TEST(TriangleTransform, IsTheIntegral) {
  for (const LinearTriangle& t : kTriangles)
    for (double size : {0.0, 1e-9, 1e-3, 0.3, 1.4, 1.6, 3.0, 10.0, 60.0})
      for (double phi = 0; phi < 6.2; phi += 0.37) {
        const PlanePoint q{size * std::cos(phi), size * std::sin(phi)};
        ASSERT_LT(std::abs(transform(t, q) - quadrature(t, q)), 2e-14 * (1 + 6 * size) * t.area() * 2)
            << size << " " << phi;
      }
}

// Directions across a side, where formulas by edges divide by zero, and such that are nearly so.
TEST(TriangleTransform, IsContinuousAtItsSingularDirections) {
  for (const LinearTriangle& t : kTriangles)
    for (int j = 0; j < 3; ++j)
      for (double size : {0.5, 5.0, 50.0})
        for (double tilt : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
          const PlanePoint a = t.corner[j], b = t.corner[(j + 1) % 3];
          const double length = std::hypot(b.x - a.x, b.y - a.y);
          const PlanePoint e{(b.x - a.x) / length, (b.y - a.y) / length};
          const PlanePoint q{size * (e.y + tilt * e.x), size * (-e.x + tilt * e.y)};
          ASSERT_LT(std::abs(transform(t, q) - quadrature(t, q)), 2e-14 * (1 + 6 * size) * t.area() * 2)
              << j << " " << size << " " << tilt;
        }
}

TEST(TriangleTransform, PowerAndMomentsAreIntegrals) {
  for (const LinearTriangle& t : kTriangles) {
    EXPECT_NEAR(power(t), over_triangle(t, 1, [](PlanePoint, Complex v) { return std::norm(v); }).real(),
                1e-14);
    const AmplitudeMoments m = amplitude_moments(std::span(&t, 1));
    const auto expect = [&](Complex moment, auto f) {
      EXPECT_LT(std::abs(moment - over_triangle(t, 1, [&](PlanePoint x, Complex v) { return f(x) * v; })),
                1e-13);
    };
    expect(m.total, [](PlanePoint) { return 1.0; });
    expect(m.x, [](PlanePoint x) { return x.x; });
    expect(m.y, [](PlanePoint x) { return x.y; });
    expect(m.xx, [](PlanePoint x) { return x.x * x.x; });
    expect(m.xy, [](PlanePoint x) { return x.x * x.y; });
    expect(m.yy, [](PlanePoint x) { return x.y * x.y; });
  }
}

// The power of the far field is that of the aperture, when all of it is counted.
TEST(TriangleTransform, SatisfiesParsevalsTheorem) {
  const LinearTriangle& t = kTriangles[1];
  const double reach = 60, step = 0.4;
  double sum = 0;
  for (double x = -reach; x < reach; x += step)
    for (double y = -reach; y < reach; y += step) sum += std::norm(transform(t, {x, y})) * step * step;
  EXPECT_NEAR(sum / (4 * M_PI * M_PI) / power(t), 1, 0.02);
}

}  // namespace
}  // namespace aureole::optics
