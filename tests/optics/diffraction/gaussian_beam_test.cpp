// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/gaussian_beam.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

/// Part of a standard normal distribution between a and b.
double between(double a, double b) { return 0.5 * (std::erf(b / M_SQRT2) - std::erf(a / M_SQRT2)); }

TEST(GaussianBeam, PowerOfRectanglesIsAProduct) {
  const GaussianBeam beam(0.7);
  for (auto [x0, x1, y0, y1] : {std::array{-1.0, 1.0, -1.0, 1.0},
                                {0.2, 3.0, -0.5, 0.1},
                                {-40.0, -0.3, -40.0, 40.0},
                                {1.0, 1.001, 2.0, 2.5},
                                {0.0, 1.0, 0.0, 2.0}}) {
    const Ring ring{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
    EXPECT_NEAR(beam.power(ring), between(x0 / 0.7, x1 / 0.7) * between(y0 / 0.7, y1 / 0.7), 1e-13);
    EXPECT_NEAR(beam.power(PolygonRegion::even_odd({ring})), beam.power(ring), 1e-13);
  }
}

TEST(GaussianBeam, PowerOfAStarWithAHoleIsAnIntegral) {
  const GaussianBeam beam(1);
  Ring star, hole;
  for (int i = 0; i < 10; ++i)
    star.push_back(
        {0.4 + (i % 2 ? 1 : 2) * std::sin(i * M_PI / 5), (i % 2 ? 1 : 2) * std::cos(i * M_PI / 5)});
  hole = testing::regular_ring(5, 0.5, 0, {0.4, 0.1});
  const PolygonRegion region = PolygonRegion::even_odd({star, hole});
  // Rows of the star, each closed by error functions.
  double sum = 0;
  constexpr int kRows = 40000;
  for (int i = 0; i < kRows; ++i) {
    const double y = -2.5 + 5 * (i + 0.5) / kRows;
    std::vector<double> ends;
    for (const Ring& ring : {star, hole})
      for (std::size_t j = 0; j < ring.size(); ++j) {
        const PlanePoint a = ring[j], b = ring[(j + 1) % ring.size()];
        if ((a.y <= y) != (b.y <= y)) ends.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
    std::sort(ends.begin(), ends.end());
    for (std::size_t j = 0; j + 1 < ends.size(); j += 2)
      sum += between(ends[j], ends[j + 1]) * std::exp(-y * y / 2) / std::sqrt(2 * M_PI) * 5 / kRows;
  }
  EXPECT_NEAR(beam.power(region), sum, 1e-7);
}

TEST(GaussianBeam, LightsWhatItReachesOfAnEdge) {
  const GaussianBeam beam(2);
  DiffractingEdge pieces[32];
  const std::size_t count = beam.light({-100, 3}, {100, 3}, 4, 0.5, pieces);
  ASSERT_EQ(count, 15u);  // 2 sqrt(64 - 9) = 14.8 in pieces of 1
  EXPECT_NEAR(pieces[0].from.x, -std::sqrt(55), 1e-9);
  EXPECT_NEAR(pieces[14].to.x, std::sqrt(55), 1e-9);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(pieces[i].a.real(), beam.amplitude(pieces[i].from), 1e-15);
    if (i > 0) {
      EXPECT_EQ(pieces[i].a, pieces[i - 1].b);
    }
  }
  // Where the pieces do not fit their number is returned, and nothing is written.
  DiffractingEdge one{};
  EXPECT_EQ(beam.light({-100, 3}, {100, 3}, 4, 0.5, std::span(&one, 1)), 15u);
  EXPECT_EQ(one.a, 0.0);
  EXPECT_EQ(beam.light({-1, 9}, {1, 9}, 4, 0.5, pieces), 0u);
  EXPECT_EQ(beam.light({1, 1}, {1, 1}, 4, 0.5, pieces), 0u);
  EXPECT_THROW(GaussianBeam(0), std::domain_error);
  EXPECT_THROW(GaussianBeam(NAN), std::domain_error);
}

TEST(GaussianBeam, CentresAreDrawnFromItsIntensity) {
  const GaussianBeam beam(3);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit;
  double xx = 0, yy = 0, inside = 0;
  constexpr int kSamples = 40000;
  for (int i = 0; i < kSamples; ++i) {
    const PlanePoint p = beam.sample(unit(random), unit(random));
    xx += p.x * p.x / kSamples, yy += p.y * p.y / kSamples,
        inside += (std::abs(p.x) < 3 && std::abs(p.y) < 3) / double(kSamples);
  }
  EXPECT_NEAR(xx, 9, 0.3);
  EXPECT_NEAR(yy, 9, 0.3);
  EXPECT_NEAR(inside, std::pow(between(-1, 1), 2), 0.01);
}

/// An obstacle of half planes, x > 0 and x < -gap, and the light that its edges diffract by q across them from a beam with the
/// centre (c, 0), the edges apart: 1 of an evenly lit edge.
struct HalfPlanes {
  double gap;
  GaussianBeam beam{1};

  double diffracted(double c) const {
    double sum = 0;
    for (double edge : {0.0, -gap}) {
      DiffractingEdge pieces[256];
      const std::size_t count = beam.light({edge - c, -20}, {edge - c, 20}, 7, 0.1, pieces);
      const double q = 50;
      sum += std::norm(q * edge_field(std::span(pieces, count), {q, 0}));
      if (gap == INFINITY) break;
    }
    return sum;
  }
  double fallen(double c) const {
    const auto half = [&](double from, double to) {
      return beam.power(Ring{{from, -40}, {to, -40}, {to, 40}, {from, 40}});
    };
    return half(-c, 40) + (gap == INFINITY ? 0 : half(-40 - gap - c, -gap - c));
  }
};

// A beam about the point that a ray hits, normalised by what it loses, diffracts too little: hits beside the obstacle are missing.
// With the centre drawn about the hit all of it comes back.
TEST(GaussianBeam, ACentreDrawnAboutTheHitLendsWhatIsDiffracted) {
  for (auto [gap, expected_db] : {std::pair(double(INFINITY), -1.59), {2.0, -1.42}}) {
    const HalfPlanes obstacle{gap};
    double lit = 0, hit = 0;
    const double step = 0.05;
    for (double c = -12; c < 12; c += step) lit += obstacle.diffracted(c) * step;
    const auto on_obstacle = [&, gap = gap](const auto& add) {
      for (double y = step / 2; y < 9; y += step) {
        add(y);
        if (gap < INFINITY) add(-gap - y);
      }
    };
    on_obstacle([&](double y) { hit += obstacle.diffracted(y) / obstacle.fallen(y) * step; });
    std::printf("gap %g sigma, beam at the hit: %.2f dB\n", gap, 10 * std::log10(hit / lit));
    EXPECT_NEAR(10 * std::log10(hit / lit), expected_db, 0.01);
    if (gap == INFINITY) {
      EXPECT_NEAR(hit / lit, std::log(2.0), 1e-3);
    }

    // D_c of beams by their centre, interpolated in a table.
    constexpr int kTable = 3000;
    const double begin = -15 - (gap < INFINITY ? gap : 0);
    std::vector<double> lent(kTable + 1);
    for (int i = 0; i <= kTable; ++i) {
      const double c = begin + i * (15 - begin) / kTable, fallen = obstacle.fallen(c);
      lent[std::size_t(i)] = fallen > 1e-13 ? obstacle.diffracted(c) / fallen : 0;
    }
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit;
    double sum = 0, squares = 0;
    int count = 0;
    on_obstacle([&](double y) {
      for (int i = 0; i < 3000; ++i, ++count) {
        const double c = y + obstacle.beam.sample(unit(random), unit(random)).x;
        const double at = std::clamp((c - begin) / (15 - begin) * kTable, 0.0, kTable - 1.0);
        const double value = std::lerp(lent[std::size_t(at)], lent[std::size_t(at) + 1], at - std::floor(at));
        sum += value, squares += value * value;
      }
    });
    const double width = gap < INFINITY ? 18 : 9, mean = sum / count,
                 error = std::sqrt((squares / count - mean * mean) / count);
    std::printf("gap %g sigma, centre drawn about the hit: %.3f +- %.3f\n", gap, mean * width / lit,
                error * width / lit);
    EXPECT_NEAR(mean * width / lit, 1, 4 * error * width / lit);
    EXPECT_LT(error * width / lit, 0.01);
  }
}

}  // namespace
}  // namespace aureole::optics
