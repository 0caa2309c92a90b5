// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

using testing::regular_ring;

struct Uniform {
  std::mt19937_64 random{11};
  double operator()() { return std::uniform_real_distribution<double>()(random); }
};

std::vector<DiffractingEdge> lit_star() {
  std::vector<DiffractingEdge> edges;
  Ring star;
  for (int i = 0; i < 10; ++i)
    star.push_back({(i % 2 ? 0.4 : 1) * std::sin(-i * M_PI / 5), (i % 2 ? 0.4 : 1) * std::cos(i * M_PI / 5)});
  for (std::size_t i = 0; i < star.size(); ++i) {
    const auto amplitude = [](PlanePoint p) {
      return std::polar(std::exp(-p.x * p.x - 0.3 * p.y), 0.7 * p.x);
    };
    const PlanePoint a = star[i], b = star[(i + 1) % star.size()];
    edges.push_back({a, b, amplitude(a), amplitude(b)});
  }
  return edges;
}

TEST(EdgeDensity, IntegratesToOne) {
  const auto edges = lit_star();
  for (ZerothOrder zeroth : {ZerothOrder::of_beam(0.5), ZerothOrder::of_beam(3), ZerothOrder::of_edges()}) {
    std::vector<EdgeDensity::Share> shares(edges.size());
    const EdgeDensity density(edges, zeroth, shares);
    // Rings up to q_max; beyond, the density falls as 1/q^3, its integral as 1/q.
    const double begin = std::log(1e-4), end = std::log(400.0);
    const int rings = 400;
    double sum = 0, ring = 0;
    for (int i = 0; i < rings; ++i) {
      const double q = std::exp(begin + (end - begin) * (i + 0.5) / rings);
      const int rays = 200 + int(16 * q);
      ring = 0;
      for (int j = 0; j < rays; ++j) {
        const double phi = 2 * M_PI * (j + 0.5) / rays;
        ring += density.pdf({q * std::cos(phi), q * std::sin(phi)}) * 2 * M_PI / rays * q * q;
      }
      sum += ring * (end - begin) / rings;
    }
    EXPECT_NEAR(sum + ring, 1, 1e-3);
  }
}

// Samples in boxes of log(along) and log(across) have the integrals of the density.
TEST(EdgeDensity, SamplesFollowAlpha) {
  Uniform uniform;
  for (bool is_alpha1 : {false, true})
    for (double sigma : {0.05, 0.2, 1.0, std::sqrt(3.0), 8.0}) {
      constexpr int kSamples = 100000, kCells = 9;
      const double begin = -3, step = 1;  // powers of e
      std::vector<int> counts(kCells * kCells);
      int negative_x = 0, negative_y = 0;
      for (int i = 0; i < kSamples; ++i) {
        const PlanePoint z = sample_canonical(is_alpha1, sigma, uniform);
        negative_x += z.x < 0, negative_y += z.y < 0;
        const int a = int(std::floor((std::log(std::abs(z.x)) - begin) / step)),
                  b = int(std::floor((std::log(std::abs(z.y)) - begin) / step));
        if (a >= 0 && a < kCells && b >= 0 && b < kCells) ++counts[a * kCells + b];
      }
      EXPECT_NEAR(negative_x, kSamples / 2, 4 * std::sqrt(kSamples) / 2);
      EXPECT_NEAR(negative_y, kSamples / 2, 4 * std::sqrt(kSamples) / 2);
      const EdgeConstants constants = edge_constants(sigma);
      const double total = is_alpha1 ? constants.alpha1 : constants.alpha2;
      double chi2 = 0;
      int cells = 0;
      for (int a = 0; a < kCells; ++a)
        for (int b = 0; b < kCells; ++b) {
          // Midpoints on as many points as the oscillation in `along` asks for.
          const int nx = 24 + int(4 * std::exp(begin + (a + 1) * step)), ny = 24;
          double integral = 0;
          for (int i = 0; i < nx; ++i)
            for (int j = 0; j < ny; ++j) {
              const double x = std::exp(begin + (a + (i + 0.5) / nx) * step),
                           y = std::exp(begin + (b + (j + 0.5) / ny) * step);
              const double alpha = is_alpha1 ? edge_alpha1(x, y) : edge_alpha2(x, y);
              integral += alpha * alpha * -std::expm1(-(x * x + y * y) / (2 * sigma * sigma)) * x * y * step *
                          step / (nx * ny);
            }
          const double expected = 4 * integral / total * kSamples;
          if (expected < 8) continue;
          chi2 += std::pow(counts[a * kCells + b] - expected, 2) / expected;
          ++cells;
        }
      EXPECT_GT(cells, 20);
      EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells)) << is_alpha1 << " " << sigma;
    }
}

// The power of all edges together, by weighting with the true |F|^2 what was drawn from single edges.
TEST(EdgeDensity, WeightedSamplesGiveThePowerWithInterference) {
  const auto edges = lit_star();
  const double sigma = 0.6;
  const ZerothOrder zeroth = ZerothOrder::of_beam(sigma);
  std::vector<EdgeDensity::Share> shares(edges.size());
  const EdgeDensity density(edges, zeroth, shares);
  Uniform uniform;
  double sum = 0, squares = 0;
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const PlanePoint q = density.sample(uniform);
    const double value = std::norm(edge_field(edges, q, zeroth)) / (4 * M_PI * M_PI) / density.pdf(q);
    sum += value, squares += value * value;
  }
  const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
  EXPECT_NEAR(mean, interfering_power(edges, sigma, 8), 4 * error);
  EXPECT_LT(error / mean, 0.02);
}

TEST(EdgeDensity, BalancingChangesTheDensityAndNotTheField) {
  const ZerothOrder zeroth = ZerothOrder::of_beam(0.1);
  // Many short edges amplify one another, two long ones of a slot cancel.
  for (const Ring& ring : {regular_ring(300, 10), Ring{{0, 0}, {40, 0}, {40, 0.2}, {0, 0.2}}}) {
    const auto edges = region_edges(PolygonRegion::even_odd({ring}));
    const double power = interfering_power(edges, 0.1);
    const double before = sampling_quality(power, edges, zeroth);
    const auto balanced = balanced_edges(edges, zeroth, power, 1000);
    const double after = sampling_quality(power, balanced, zeroth);
    std::printf("quality %.3f with %zu edges -> %.3f with %zu\n", before, edges.size(), after,
                balanced.size());
    EXPECT_LE(std::abs(std::log(after)), std::abs(std::log(before)));
    // Weighted samples of the balanced density still give the power of the original edges.
    std::vector<EdgeDensity::Share> shares(balanced.size());
    const EdgeDensity density(balanced, zeroth, shares);
    Uniform uniform;
    double sum = 0, squares = 0;
    constexpr int kSamples = 4000;
    for (int i = 0; i < kSamples; ++i) {
      const PlanePoint q = density.sample(uniform);
      const double value = std::norm(edge_field(edges, q, zeroth)) / (4 * M_PI * M_PI) / density.pdf(q);
      sum += value, squares += value * value;
    }
    const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, power, 4 * error + 0.005 * power);
  }
}

TEST(EdgeDensity, AnEvenlyLitEdgeWithItsZerothOrderHasNone) {
  const DiffractingEdge even{{0, 0}, {1, 0}, 1, 1}, odd{{0, 0}, {1, 0}, 1, -1};
  EdgeDensity::Share share;
  EXPECT_THROW(EdgeDensity(std::span(&even, 1), ZerothOrder::kept(), std::span(&share, 1)),
               std::domain_error);
  EXPECT_NEAR(EdgeDensity(std::span(&odd, 1), ZerothOrder::kept(), std::span(&share, 1)).total(),
              4 / (64 * M_PI), 1e-12);
}

}  // namespace
}  // namespace aureole::optics
