// SPDX-License-Identifier: Apache-2.0
// Sums of boundary waves against Fresnel's integrals, against quadrature, and against Kirchhoff's integral over openings.
#include "aureole/optics/diffraction/boundary_wave.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "aureole/optics/faddeeva.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
constexpr double kNoWindow = 1e6;

/// The field behind a polygonal opening about the axis, in the Fresnel plane, run counter-clockwise.
Complex field_of(const std::vector<PlanePoint>& ring, bool axis_is_open, double window = kNoWindow) {
  Complex field = axis_is_open;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const PlanePoint a = ring[i], b = ring[(i + 1) % ring.size()];
    field -= (a.x * b.y - a.y * b.x >= 0 ? 1.0 : -1.0) * BoundaryPiece(a, b).wave(1, window);
  }
  return field;
}

/// The field behind a slit from a to b.
Complex slit(double a, double b) { return Complex(0.5, -0.5) * (fresnel_integral(b) - fresnel_integral(a)); }

TEST(BoundaryWave, RectanglesAreProductsOfFresnelIntegrals) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  double worst = 0;
  for (int n = 0; n < 5000; ++n) {
    const double x0 = 4 - 12 * u(random), x1 = x0 + 10 * u(random);
    const double y0 = 4 - 12 * u(random), y1 = y0 + 10 * u(random);
    const bool is_open = x0 < 0 && x1 > 0 && y0 < 0 && y1 > 0;
    const Complex field = field_of({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, is_open);
    worst = std::max(worst, std::abs(field - slit(x0, x1) * slit(y0, y1)));
  }
  std::printf("rectangles: error of the field %.1e\n", worst);
  EXPECT_LT(worst, 1e-5);
}

TEST(BoundaryWave, CornersOfTheTableAreThoseOfQuadrature) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(0, 1);
  double of_table = 0, of_quadrature = 0;
  for (int n = 0; n < 3000; ++n) {
    const double r = 80 * std::pow(u(random), 3), psi = M_PI / 2 * u(random) * u(random);
    const Complex corner = corner_wave_by_quadrature(r, psi);
    of_table = std::max(of_table, std::abs(corner_wave(r, psi) - corner));
    // The wave between the foot and the end by the midpoint rule, where it oscillates little.
    if (r > 6) continue;
    const double v = r * std::cos(psi);
    Complex sum = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = std::cos(psi * (i + 0.5) / kSteps);
      sum += std::polar(psi / kSteps / (2 * M_PI), M_PI / 2 * v * v / (c * c));
    }
    of_quadrature = std::max(of_quadrature, std::abs(corner - (0.5 * knife_edge_field(-v) - sum)));
  }
  std::printf("corners: error of the table %.1e, of the quadrature %.1e\n", of_table, of_quadrature);
  EXPECT_LT(of_table, 5e-5);
  EXPECT_LT(of_quadrature, 2e-5);
  EXPECT_NEAR(std::abs(corner_wave_by_quadrature(7, 0) - 0.5 * knife_edge_field(-7)), 0, 1e-14);
  EXPECT_NEAR(corner_wave_by_quadrature(0, 0.3).real(), (M_PI / 2 - 0.3) / (2 * M_PI), 1e-15);
}

TEST(BoundaryWave, DiscsHaveTheirSpot) {
  // A disc whose rim is at v everywhere: on the axis the field is exp(i pi v^2/2), of modulus 1 behind the disc.
  for (const double v : {0.5, 2.0, 5.39, 12.0}) {
    std::vector<PlanePoint> rim;
    constexpr int kSides = 2000;
    for (int i = 0; i < kSides; ++i)
      rim.push_back({v * std::cos(2 * M_PI * i / kSides), v * std::sin(2 * M_PI * i / kSides)});
    const Complex opening = field_of(rim, true);
    EXPECT_NEAR(std::abs(opening - (1.0 - std::polar(1.0, M_PI / 2 * v * v))), 0, 1e-5 * (1 + 4 * v * v))
        << v;  // the rim is a polygon
    EXPECT_NEAR(std::abs(1.0 - opening), 1, 1e-5 * (1 + 4 * v * v)) << v;
  }
}

TEST(BoundaryWave, CutsOfALineChangeNothing) {
  const PlanePoint a{-3, 0.7}, b{40, 2.1};
  for (const double window : {4.0, 15.0, kNoWindow}) {
    const Complex whole = BoundaryPiece(a, b).wave(1, window);
    Complex sum = 0;
    constexpr int kPieces = 37;
    const auto at = [&](int i) {
      const double t = double(i) / kPieces;
      return PlanePoint{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    };
    for (int i = 0; i < kPieces; ++i) sum += BoundaryPiece(at(i), at(i + 1)).wave(1, window);
    EXPECT_NEAR(std::abs(sum - whole), 0, 1e-12) << window;
  }
}

/// Two half planes: the field of the first in the plane of the second, integrated over what the second leaves open. The
/// distances are r1, L and r2, the wavelength 1; h1 and h2 the heights of the edges over the way.
Complex field_of_two(double h1, double h2, double r1, double L, double r2) {
  const double f = std::sqrt(2 * (1 / (r1 + L) + 1 / r2)), f1 = std::sqrt(2 * (1 / r1 + 1 / L));
  // t is Fresnel's parameter in the plane of the second edge; a smooth end far out stands for infinity.
  const double begin = h2 * f, length = 80;
  constexpr int kSteps = 400000;
  Complex sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) / kSteps, t = begin + s * length;
    const double end = std::max(0.0, s - 0.5) / 0.16;
    const Complex first = knife_edge_field((t / f * r1 / (r1 + L) - h1) * f1);
    sum += std::polar(length / kSteps * std::exp(-end * end * end * end), M_PI / 2 * t * t) * first;
  }
  return Complex(0.5, -0.5) * sum;
}

TEST(BoundaryWave, TwoEdgesAreTheirDoubleIntegral) {
  double worst = 0;
  for (const double L : {0.01, 0.1, 1.0, 10.0})
    for (const auto& [h1, h2] : {std::pair(0.7, 0.7), {0.3, -0.4}, {-0.5, 0.6}, {0.0, 0.0}, {-1.0, -0.8}}) {
      const double r1 = 1, r2 = 1.3;
      const double v1 = -h1 * std::sqrt(2 * (1 / r1 + 1 / (L + r2))),
                   v2 = -h2 * std::sqrt(2 * (1 / (r1 + L) + 1 / r2));
      const double rho = std::sqrt(r1 * r2 / ((r1 + L) * (r2 + L)));
      worst = std::max(worst, std::abs(two_edges_field(v1, v2, rho) - field_of_two(h1, h2, r1, L, r2)));
    }
  std::printf("two edges: error of the field %.1e\n", worst);
  EXPECT_LT(worst, 2e-5);
  // Both at v = -1, r1 = r2 = 1: the product of two knife edges, and one of them alone, are this much off [dB].
  const auto db = [](const Complex& u) { return 20 * std::log10(std::abs(u)); };
  const double one = db(knife_edge_field(-1));
  const struct {
    double L, product, single;
  } kRows[] = {{0.01, -13.0, 0.83}, {0.1, -11.2, 2.71}, {1, -6.1, 7.74}, {10, -1.24, 12.62}};
  for (const auto& [L, product, single] : kRows) {
    const double both = db(two_edges_field(-1, -1, 1 / (1 + L)));
    EXPECT_NEAR(2 * one - both, product, 0.06) << L;
    EXPECT_NEAR(one - both, single, 0.02) << L;
  }
  EXPECT_NEAR(std::abs(two_edges_field(-0.7, 0.4, 0) - knife_edge_field(-0.7) * knife_edge_field(0.4)), 0,
              1e-5);
  EXPECT_NEAR(std::abs(two_edges_field(-0.7, 0.4, 1) - knife_edge_field(-0.7)), 0, 1e-5);
  EXPECT_NEAR(std::abs(two_edges_field(0.7, 0.4, -1) - (knife_edge_field(0.7) + knife_edge_field(0.4) - 1.0)),
              0, 1e-5);
}

TEST(BoundaryWave, TheWindowIsSmooth) {
  EXPECT_EQ(window_weight(-15, 15), 1);
  EXPECT_NEAR(window_weight(20, 15), 0, 1e-12);
  EXPECT_NEAR(window_weight(17.5, 15), 0.5, 1e-12);
  // A line that moves through the window's border: no step is larger than the wave there.
  double largest = 0;
  Complex last = BoundaryPiece({-9, 14}, {300, 14}).wave(1, 15);
  for (double y = 14; y < 21; y += 0.001) {
    const Complex next = BoundaryPiece({-9, y}, {300, y}).wave(1, 15);
    largest = std::max(largest, std::abs(next - last));
    last = next;
  }
  EXPECT_LT(largest, 2e-3);
  EXPECT_EQ(last, Complex(0));
}

// The waves of two parallel edges, each changed by the other, are their common field.
TEST(BoundaryWave, EdgesChangeEachOthersWaves) {
  for (const double rho : {-0.9, -0.3, 0.2, 0.9, 0.999})
    for (const double v1 : {-3.0, -0.5, 0.4, 2.0})
      for (const double v2 : {-2.0, -0.6, 0.3, 2.5}) {
        const double root = std::sqrt(1 - rho * rho), w1 = (v1 - rho * v2) / root,
                     w2 = (v2 - rho * v1) / root;
        const auto wave = [](double v) { return (v > 0 ? -1.0 : 1.0) * knife_edge_field(-std::abs(v)); };
        const std::complex<double> sum = (v1 > 0 && v2 > 0 ? 1.0 : 0.0) + wave(v1) * wave_past_edge(v1, w2) +
                                         wave(v2) * wave_past_edge(v2, w1);
        EXPECT_LT(std::abs(sum - two_edges_field(v1, v2, rho)), 3e-4) << rho << " " << v1 << " " << v2;
      }
  // Far from the second edge the wave is as it was, or nothing.
  EXPECT_LT(std::abs(wave_past_edge(1, 60) - 1.0), 0.01);
  EXPECT_LT(std::abs(wave_past_edge(1, -60)), 0.01);
  // In one direction: the integral over s of the wave at s v times the knife edge's field at s w.
  for (const double w : {-1.5, 0.0, 0.7}) {
    const double v = 0.8, length = 60;
    constexpr int kSteps = 400000;
    std::complex<double> sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double q = (i + 0.5) / kSteps, s = 1 + q * length, end = std::max(0.0, q - 0.5) / 0.16;
      sum +=
          std::polar(length / kSteps * s * std::exp(-end * end * end * end), M_PI / 2 * v * v * (s * s - 1)) *
          knife_edge_field(s * w);
    }
    const std::complex<double> expected = std::complex<double>(0, -M_PI * v * v) * sum;
    EXPECT_LT(std::abs(wave_past_edge(v, w, 0) - expected), 2e-3) << w;
  }
}

}  // namespace
}  // namespace aureole::optics
