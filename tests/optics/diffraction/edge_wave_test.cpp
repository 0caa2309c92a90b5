// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_wave.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <random>

#include "aureole/optics/aperture/aperture_transform.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;
using testing::scanline_transform;

struct Opening {
  const char* name;
  std::vector<Ring> rings;
};

Ring rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

/// In wavelengths.
std::vector<Opening> openings() {
  Ring star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 ? 4 : 10;
    star.push_back({r * std::sin(i * M_PI / 5), r * std::cos(i * M_PI / 5)});
  }
  return {{"slit", {rectangle(-1, -20, 2, 40)}},
          {"double slit", {rectangle(-4, -20, 2, 40), rectangle(2, -20, 2, 40)}},
          {"square", {rectangle(-10, -10, 20, 20)}},
          {"disc", {regular_ring(128, 10)}},
          {"star", {star}},
          {"ring", {regular_ring(96, 10), regular_ring(96, 7)}}};
}

// Fraunhofer's integral by quadrature over scan lines, at angles where light still is.
TEST(EdgeWave, SumsAreFraunhofersIntegral) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit;
  for (const Opening& opening : openings()) {
    const PolygonRegion region = PolygonRegion::even_odd(opening.rings);
    const auto edges = region_edges(region);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      const double size = 2 * M_PI * std::pow(10, -3 * unit(random)),
                   phi = i < 8 ? i * M_PI / 4 : 2 * M_PI * unit(random);
      const PlanePoint q{size * std::cos(phi), size * std::sin(phi)};
      worst = std::max(worst, std::abs(edge_field(edges, q) - scanline_transform(opening.rings, q.x, q.y)) /
                                  region.area());
    }
    std::printf("%-11s far field: edge waves - Fraunhofer, largest of 60 directions: %.1e of the area\n",
                opening.name, worst);
    EXPECT_LT(worst, 1e-10) << opening.name;
  }
}

TEST(EdgeWave, FineDiscIsAirysPattern) {
  const auto edges = region_edges(PolygonRegion::even_odd({regular_ring(4096, 10)}));
  for (double u = 0.5; u < 40; u += 0.7)
    EXPECT_NEAR(edge_field(edges, {u / 10, 0}).real(), circle_aperture_transform(u / 10, 10),
                1e-6 * M_PI * 100)
        << u;
}

// S2.16 in its own symbols, term by term, against an integral along the edge.
TEST(EdgeWave, IsTheIntegralAlongItsEdge) {
  using Rule = boost::math::quadrature::gauss<double, 30>;
  const DiffractingEdge edge{{0.3, -1}, {1.1, 0.7}, {0.2, 1}, {-1, 0.4}};
  for (double size : {1e-4, 0.03, 0.11, 1.0, 20.0})
    for (double phi = 0.05; phi < 6.2; phi += 0.31) {
      const PlanePoint q{size * std::cos(phi), size * std::sin(phi)};
      std::complex<double> line = 0;
      for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
        for (int side : {-1, 1}) {
          const double t = 0.5 * (1 + side * Rule::abscissa()[k]);
          const PlanePoint x{0.3 + 0.8 * t, -1 + 1.7 * t};
          line += 0.5 * Rule::weights()[k] * (edge.a + t * (edge.b - edge.a)) *
                  std::polar(1.0, -(q.x * x.x + q.y * x.y));
        }
      const std::complex<double> expected =
          std::complex<double>(0, (q.x * 1.7 - q.y * 0.8) / (size * size)) * line;
      EXPECT_LT(std::abs(edge_wave(edge, q) - expected), 1e-13 * std::abs(expected) + 1e-13 / size)
          << size << " " << phi;
      // alpha_1 and alpha_2, the same wave in canonical coordinates.
      const double along = q.x * 0.8 + q.y * 1.7, across = q.x * 1.7 - q.y * 0.8,
                   length2 = 0.8 * 0.8 + 1.7 * 1.7;
      const std::complex<double> canonical =
          2 * M_PI * length2 * std::polar(1.0, -(q.x * 0.7 + q.y * -0.15)) *
          ((edge.a - edge.b) * edge_alpha1(along, across) +
           std::complex<double>(0, 1) * edge.mean() * edge_alpha2(along, across));
      EXPECT_LT(std::abs(canonical - expected), 1e-13 * std::abs(expected) + 1e-13 / size);
    }
}

TEST(EdgeWave, SplittingAndJoiningBackChangesNothing) {
  const DiffractingEdge edge{{0.3, -1}, {1.1, 0.7}, {0.2, 1}, {-1, 0.4}};
  const auto [first, second] = split(edge, 0.3);
  const DiffractingEdge whole = join(first, second);
  for (double phi = 0; phi < 6.2; phi += 0.31) {
    const PlanePoint q{3 * std::cos(phi), 3 * std::sin(phi)};
    EXPECT_LT(std::abs(edge_wave(first, q) + edge_wave(second, q) - edge_wave(edge, q)), 1e-15);
    EXPECT_EQ(edge_wave(whole, q), edge_wave(edge, q));
  }
}

/// Integral of exp(-x^2/4) exp(-i q x) from a to b.
std::complex<double> gaussian_interval(double a, double b, double q) {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  const int cells = 2 + int(std::abs(q) * (b - a) / 6);
  std::complex<double> sum = 0;
  for (int c = 0; c < cells; ++c)
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1}) {
        const double x = a + (b - a) * (c + 0.5 + 0.5 * side * Rule::abscissa()[k]) / cells;
        sum += 0.5 * Rule::weights()[k] * (b - a) / cells * std::polar(std::exp(-x * x / 4), -q * x);
      }
  return sum;
}

// Their S2.9 drops a term with the gradient of the amplitude: |gradient|/|q amplitude| of the wave. Lengths in standard
// deviations of the beam's intensity, whose own spectrum then has one of 1/2.
TEST(EdgeWave, TheDroppedGradientMattersNearTheZerothOrder) {
  const auto amplitude = [](PlanePoint p) { return std::exp(-(p.x * p.x + p.y * p.y) / 4); };
  std::vector<DiffractingEdge> edges;
  const PlanePoint corners[4] = {{-1.6, -2}, {2.4, -2}, {2.4, 2}, {-1.6, 2}};
  for (int i = 0; i < 4; ++i)
    for (int piece = 0; piece < 64; ++piece) {
      const PlanePoint a = corners[i], b = corners[(i + 1) % 4];
      const auto at = [&](double t) { return PlanePoint{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; };
      const PlanePoint from = at(piece / 64.), to = at((piece + 1) / 64.);
      edges.push_back({from, to, amplitude(from), amplitude(to)});
    }
  double last = 0;
  for (double q : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
    double wrong = 0, right = 0;
    for (int i = 0; i < 800; ++i) {  // a spiral from q to 1.5 q
      const double phi = i * 2 * M_PI * 0.6180339887, length = q * (1 + 0.5 * i / 800);
      const PlanePoint at{length * std::cos(phi), length * std::sin(phi)};
      const auto exact = gaussian_interval(-1.6, 2.4, at.x) * gaussian_interval(-2, 2, at.y);
      wrong += std::norm(edge_field(edges, at) - exact), right += std::norm(exact);
    }
    last = std::sqrt(wrong / right);
    std::printf("q sigma = %4g: edge waves differ from the exact transform by %.3f (rms over a ring)\n", q,
                last);
    EXPECT_LT(last, 1.2 / q);
  }
}

TEST(ZerothOrder, RemovesAGaussianOfPower) {
  const auto edges = region_edges(PolygonRegion::even_odd({rectangle(-10, -10, 20, 20)}));
  const double sigma = 0.05;
  for (double q : {0.01, 0.05, 0.3}) {
    const double kept = std::norm(edge_field(edges, {q, 0.3 * q}));
    EXPECT_NEAR(std::norm(edge_field(edges, {q, 0.3 * q}, ZerothOrder::of_beam(sigma))),
                kept * (1 - std::exp(-1.09 * q * q / (2 * sigma * sigma))), 1e-12 * kept + 1e-9);
  }
  EXPECT_EQ(edge_field(edges, {0, 0}, ZerothOrder::of_beam(sigma)), 0.0);
  EXPECT_EQ(edge_field(edges, {0, 0}, ZerothOrder::of_edges()), 0.0);
  EXPECT_DOUBLE_EQ(ZerothOrder::of_edges().remainder(0.04, 3), 1 - std::exp(-0.04 * 9 / 6));
}

}  // namespace
}  // namespace aureole::optics
