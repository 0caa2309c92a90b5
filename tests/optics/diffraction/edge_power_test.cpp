// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_power.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "aureole/optics/aperture/aperture_transform.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;

/// Integral over the plane of (1 - chi) alpha^2 in polar coordinates, on rings with logarithmic radii, from the formulas S2.20
/// and S2.21 as printed. Beyond the last ring the mean of the square is 1/2 in `across` (for both kinds), so that what
/// is left falls as 1/radius.
double quadrature(bool is_alpha1, double sigma) {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  const auto factor = [&](double x) {
    const double sinc = x == 0 ? 1 : std::sin(x / 2) / (x / 2);
    if (!is_alpha1) return sinc;
    return std::abs(x) < 1e-3 ? -x / 12 : (std::cos(x / 2) - sinc) / x;
  };
  const double begin = std::log(1e-6), end = std::log(2000.0);
  const int cells = 300;
  double sum = 0, ring = 0, radius = 0;
  for (int c = 0; c < cells; ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      static constexpr double kNodes[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                           0.8611363115940526},
                              kWeights[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                             0.3478548451374538};
      radius = std::exp(begin + (end - begin) * (c + 0.5 + 0.5 * kNodes[k]) / cells);
      const double removed = sigma > 0 ? -std::expm1(-radius * radius / (2 * sigma * sigma)) : 1;
      ring = 0;
      const int slices = 4 + int(radius / 4);
      for (int s = 0; s < slices; ++s)  // a quarter of the circle
        for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
          for (int side : {-1, 1}) {
            const double phi = 0.5 * M_PI * (s + 0.5 + 0.5 * side * Rule::abscissa()[i]) / slices;
            ring += 0.5 * Rule::weights()[i] / slices *
                    std::pow(std::sin(phi) * factor(radius * std::cos(phi)), 2);
          }
      ring *= 2 * M_PI * removed;
      sum += 0.5 * kWeights[k] * (end - begin) / cells * ring;
    }
  return (sum + ring * radius / std::exp(end)) / (4 * M_PI * M_PI);
}

TEST(EdgePower, ConstantsAreIntegrals) {
  const EdgeConstants published = edge_constants(std::sqrt(3.0));
  std::printf("I1 = %.9f, I2 = %.9f\n", published.alpha1, published.alpha2);
  EXPECT_NEAR(published.alpha1, 0.0046127, 5e-8);
  EXPECT_NEAR(published.alpha2, 0.1245899, 1e-7);
  EXPECT_NEAR(edge_constants(0).alpha1, 0.00497359, 5e-9);
  EXPECT_EQ(edge_constants(0).alpha2, INFINITY);
  for (double sigma : {0.03, 0.1, 0.15, 0.7, std::sqrt(3.0), 6.0, 40.0}) {
    const EdgeConstants c = edge_constants(sigma);
    EXPECT_NEAR(c.alpha1 / quadrature(true, sigma), 1, 2e-5) << sigma;
    EXPECT_NEAR(c.alpha2 / quadrature(false, sigma), 1, 2e-5) << sigma;
  }
  EXPECT_NEAR(edge_constants(0).alpha1 / quadrature(true, 0), 1, 2e-5);
}

// The term of alpha_1 alpha_2 is odd in `along`: it integrates to 0 over each ring but is not 0 on it.
TEST(EdgePower, TheMixedTermIsOdd) {
  for (double x : {0.3, 2.0, 7.0})
    for (double y : {0.2, 3.0})
      EXPECT_EQ(edge_alpha1(x, y) * edge_alpha2(x, y), -edge_alpha1(-x, y) * edge_alpha2(-x, y));
  EXPECT_GT(std::abs(edge_alpha1(2, 1) * edge_alpha2(2, 1)), 1e-4);
}

Ring square(double side, int pieces) {
  const PlanePoint corners[4] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
  Ring ring;
  for (int i = 0; i < 4; ++i)
    for (int p = 0; p < pieces; ++p) {
      const PlanePoint a = corners[i], b = corners[(i + 1) % 4];
      const double t = double(p) / pieces;
      ring.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  return ring;
}

std::vector<DiffractingEdge> cut_square(double side, int pieces) {
  const Ring ring = square(side, pieces);
  std::vector<DiffractingEdge> edges;
  for (std::size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()], 1, 1});
  return edges;
}

// Lengths in wavelengths; all real directions.
TEST(EdgePower, WithOneLobePerEdgeItDependsOnHowEdgesAreCut) {
  const double q_max = 2 * M_PI;
  const double expected[] = {0.68, 0.40, 0.21, 0.10, 0.05};
  for (int i = 0, pieces = 1; i < 5; ++i, pieces *= 2) {
    const double d = diffracted_power(cut_square(20, pieces), ZerothOrder::of_edges(), q_max) / 400;
    std::printf("square of 20 wavelengths, sides in %2d pieces, chi of edges: D = %.3f\n", pieces, d);
    EXPECT_NEAR(d, expected[i], 0.007);
  }
  const double of_disc[] = {0.17, 0.035, 0.004};
  for (int i = 0, count = 16; i < 3; ++i, count *= 4) {
    const auto region = PolygonRegion::even_odd({regular_ring(count, 10)});
    const double d = diffracted_power(region_edges(region), ZerothOrder::of_edges(), q_max) / region.area();
    std::printf("disc of radius 10 wavelengths, %3d edges, chi of edges: D = %.4f\n", count, d);
    EXPECT_NEAR(d, of_disc[i], 0.03 * of_disc[i] + 0.0005);
  }
}

TEST(EdgePower, WithOneLobePerBeamItDoesNot) {
  const double sigma = 1 / (2 * 5.0);  // of a beam of standard deviation 5
  const double whole = interfering_power(cut_square(20, 1), sigma, 8);
  for (int pieces : {2, 4, 16}) {
    const double cut = interfering_power(cut_square(20, pieces), sigma, 8);
    std::printf("square of 20 wavelengths, sides in %2d pieces, chi of the beam: D = %.5f\n", pieces,
                cut / 400);
    EXPECT_NEAR(cut / whole, 1, 2e-4);
  }
  // By quadrature over all real directions; a part 1/(pi k side) of the light goes to none.
  EXPECT_NEAR(diffracted_power(cut_square(20, 1), ZerothOrder::of_beam(sigma), 4 * M_PI) / whole, 1, 0.02);
}

// Diffracted power of a disc from Airy's pattern: the integral over q of |F|^2 (1 - chi).
TEST(EdgePower, OfADiscIsThatOfItsPattern) {
  const double radius = 3, sigma = 0.4;
  double exact = 0;
  const double step = 1e-3;
  for (double q = step / 2; q < 200; q += step)
    exact += std::pow(circle_aperture_transform(q, radius), 2) * -std::expm1(-q * q / (2 * sigma * sigma)) *
             q * step / (2 * M_PI);
  exact += 2 * radius / (M_PI * 200) * M_PI / 2;  // beyond, the mean of J1^2
  const auto edges = region_edges(PolygonRegion::even_odd({regular_ring(200, radius)}));
  for (int nodes : {2, 4, 8}) EXPECT_NEAR(interfering_power(edges, sigma, nodes) / exact, 1, 1e-3) << nodes;
}

// An amplitude that changes along the edges, complex: pairs against the quadrature over q.
TEST(EdgePower, OfComplexAmplitudesIsTheIntegralOverDirections) {
  std::vector<DiffractingEdge> edges;
  const Ring ring = square(3, 2);
  const auto amplitude = [](PlanePoint p) { return std::polar(1 + 0.3 * p.x, 0.8 * p.x - 0.5 * p.y); };
  for (std::size_t i = 0; i < ring.size(); ++i)
    edges.push_back(
        {ring[i], ring[(i + 1) % ring.size()], amplitude(ring[i]), amplitude(ring[(i + 1) % ring.size()])});
  const double sigma = 0.5, all = interfering_power(edges, sigma, 8);
  const double q_max = 120, inside = diffracted_power(edges, ZerothOrder::of_beam(sigma), q_max);
  // Beyond: every edge alone, 2/(4 pi^2 q_max) of the integral of its |amplitude|^2.
  double line = 0;
  for (const DiffractingEdge& e : edges)
    line += e.length() * (std::norm(e.mean()) + std::norm(e.a - e.b) / 12);
  EXPECT_NEAR((inside + line / (M_PI * q_max)) / all, 1, 2e-3);
}

// An edge between two lit regions diffracts nothing: it is there twice, once each way.
TEST(EdgePower, EdgesThatLieOnOneAnother) {
  const DiffractingEdge edge{{0, 0}, {2, 1}, {1, 0.4}, {-0.3, 1}}, back{edge.to, edge.from, edge.b, edge.a};
  const double alone = interfering_power(std::span(&edge, 1), 0.7);
  for (int nodes : {2, 8}) {
    const DiffractingEdge both[3] = {edge, back, {{1, 1}, {1, 1}, 1, 1}};
    EXPECT_NEAR(interfering_power(both, 0.7, nodes), 0, 1e-12);
    const DiffractingEdge twice[2] = {edge, edge};
    EXPECT_NEAR(interfering_power(twice, 0.7, nodes), 4 * alone, 1e-12);
  }
}

TEST(EdgePower, TheZerothOrderOfASquareByItsCurvature) {
  // |F|^2 near 0 of a square of side L: L^4 (1 - q^2 L^2/12); the same centred anywhere.
  for (double at : {0.0, 100.0}) {
    const LinearTriangle halves[2] = {{{{{at, 0}, {at + 2, 0}, {at + 2, 2}}}, {1, 1, 1}},
                                      {{{{at, 0}, {at + 2, 2}, {at, 2}}}, {1, 1, 1}}};
    const double sigma = 0.7;
    EXPECT_NEAR(zeroth_order_power(halves, sigma), 16 / (2 * M_PI) / (4.0 / 6 + 1 / (sigma * sigma)), 1e-9);
  }
  const LinearTriangle dark{{{{0, 0}, {1, 0}, {0, 1}}}, {1, -1, 0}};
  EXPECT_THROW(zeroth_order_power(std::span(&dark, 1), 1), std::domain_error);
  EXPECT_NEAR(mean_edge_sigma(cut_square(20, 2)), std::sqrt(3.0) / 10, 1e-12);
}

}  // namespace
}  // namespace aureole::optics
