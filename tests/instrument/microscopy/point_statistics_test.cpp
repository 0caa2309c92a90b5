// SPDX-License-Identifier: Apache-2.0
// g(r) and S(q) of points through a window against those of the whole periodic sample, and against random
// points, for which both are 1.
#include "aureole/instrument/microscopy/point_statistics.h"

#include <gtest/gtest.h>

#include <complex>
#include <cstdio>

#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/microscopy/observation_window.h"
#include "instrument/microscopy/disc_pictures.h"

namespace aureole::test {
namespace {

PointField field_of(const std::vector<std::array<double, 2>>& points, const ObservationWindow& window,
                    double margin, bool masked) {
  PointField f;
  const auto raster = window.raster(margin, 512);
  f.columns = raster.width, f.rows = raster.height, f.cell_x = raster.cell_x, f.cell_y = raster.cell_y;
  double most = 0;
  for (const float v : raster.free) most = std::max<double>(most, v);
  for (const float v : raster.free)
    f.taper.push_back(0.5f - 0.5f * float(std::cos(M_PI * std::min(1.0, v / (0.25 * most)))));
  for (const float v : raster.inside) f.area += v * f.cell_x * f.cell_y;
  const auto covariance = std::make_shared<SetCovariance>(window, margin, masked);
  f.covariance = [covariance](double x, double y) { return (*covariance)(x, y); };
  f.block_area = {f.area};
  for (const auto& p : points)
    if (window.free(p[0], p[1]) >= margin && window.free(p[0], p[1]) > 0)
      f.x.push_back(p[0]), f.y.push_back(p[1]), f.block.push_back(0);
  return f;
}

std::vector<double> g_of(const PointField& f, double width, int bins) {
  const PairCounts pairs = count_pairs({f}, width, bins);
  const double density = double(f.x.size()) / f.area;
  std::vector<double> g;
  for (int i = 0; i < bins; ++i)
    g.push_back(pairs.weighted[0][size_t(i)] / (density * density * M_PI * width * width * (2 * i + 1)));
  return g;
}

std::vector<std::uint8_t> with_holes(int size) {
  std::vector<std::uint8_t> seen(size_t(size) * size, 1);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      if (std::hypot(x - 0.3 * size, y - 0.35 * size) < 0.13 * size || (x > 0.6 * size && y > 0.75 * size))
        seen[size_t(y) * size + x] = 0;
  return seen;
}

TEST(PointStatistics, RandomPointsAreRandom) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(0, 1000);
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i < 8000; ++i) points.push_back({u(random), u(random)});
  for (const bool masked : {false, true}) {
    const ObservationWindow window(1000, 1000, masked ? with_holes(1000) : std::vector<std::uint8_t>());
    const PointField f = field_of(points, window, 10, masked);
    // Pairs up to a fifth of the window: without edge correction g would fall to 0.75 there.
    const std::vector<double> g = g_of(f, 20, 10);
    for (size_t i = 0; i < g.size(); ++i) EXPECT_NEAR(g[i], 1, 0.02) << masked << " " << i;
    const RingMeans s = structure_factor_of({f}, 0.01, 40);
    ASSERT_GE(s.q.size(), 35u);
    int held = 0;
    for (size_t i = 0; i < s.q.size(); ++i) held += std::abs(s.value[i] - 1) < 1.96 * s.error[i];
    std::printf("masked %d: %d of %zu rings hold S = 1; lowest q %.4f S %.3f\n", masked, held, s.q.size(),
                s.q[0], s.value[0]);
    EXPECT_GE(held, int(0.85 * double(s.q.size())));
  }
}

TEST(ObservationWindow, AreaAndCovarianceOfHoles) {
  const int n = 200;
  const auto seen = with_holes(n);
  const ObservationWindow window(n, n, seen);
  for (const double reach : {0.5, 3.5, 10.5}) {
    double count = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        bool fits = true;
        const int k = int(reach);
        for (int j = y - k; j <= y + k && fits; ++j)
          for (int i = x - k; i <= x + k && fits; ++i)
            fits = i >= 0 && j >= 0 && i < n && j < n && seen[size_t(j) * n + size_t(i)];
        count += fits;
      }
    EXPECT_EQ(window.area(reach), count) << reach;
  }
  const SetCovariance covariance(window, 0, true);
  for (const auto& [dx, dy] : {std::pair(0, 0), {17, 5}, {-30, 12}, {3, -40}, {150, 150}}) {
    double count = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const int i = x + dx, j = y + dy;
        count += seen[size_t(y) * n + size_t(x)] && i >= 0 && j >= 0 && i < n && j < n &&
                 seen[size_t(j) * n + size_t(i)];
      }
    EXPECT_NEAR(covariance(dx, dy), count, 1 + 1e-3 * count) << dx << " " << dy;
  }
  const ObservationWindow whole(n, n, {});
  EXPECT_EQ(whole.area(10), 180.0 * 180);
  EXPECT_EQ(SetCovariance(whole, 10, false)(20, -30), 160.0 * 150);
}

TEST(PointStatistics, WindowAgreesWithThePeriodicSample) {
  // The truth: S on the vectors of the period, mean over many samples; the estimate: one picture of one.
  constexpr double kRadius = 8, kStep = 0.2;
  constexpr int kRings = 50, kTruth = 12;
  std::vector<double> truth(kRings), count(kRings);
  double side = 0;
  for (unsigned k = 0; k < kTruth; ++k) {
    const auto discs = hard_discs(0.4, kRadius, side, 600, 100 + k, 150);
    const double q0 = 2 * M_PI / side;
    for (int ky = -80; ky <= 80; ++ky)
      for (int kx = 0; kx <= 80; ++kx) {
        const double u = std::hypot(kx, ky) * q0 * kRadius;
        if (u >= kStep * kRings || (kx == 0 && ky <= 0) || (std::abs(kx + ky * 7) % 4 && u > 2)) continue;
        std::complex<double> sum = 0;
        for (const Disc& d : discs) sum += std::polar(1.0, -q0 * (kx * d.x + ky * d.y));
        truth[size_t(u / kStep)] += std::norm(sum) / double(discs.size()), count[size_t(u / kStep)] += 1;
      }
  }
  const auto discs = hard_discs(0.4, kRadius, side, 2600, 7, 200);
  PictureOptions p;
  p.width = p.height = 1000;
  ASSERT_GT(side, 1000);
  const Micrograph picture = picture_of(discs, side, p);
  const Microstructure m = analyse_microstructure(
      1, [&](size_t) { return picture; }, {}, nullptr);
  const auto& s = m.structure_factor;
  int held = 0, all = 0;
  for (size_t i = 0; i < s.x.size(); ++i) {
    const double at = s.x[i] / kStep - 0.5;
    const size_t k = size_t(std::max(at, 0.0));
    if (k + 1 >= size_t(kRings) || !(count[k] > 0)) continue;
    const double t = std::max(at, 0.0) - double(k);
    const double v = truth[k] / count[k] * (1 - t) + t * truth[k + 1] / count[k + 1];
    const double e = std::hypot(s.error[i], v / std::sqrt(count[k]));
    ++all, held += std::abs(s.value[i] - v) < 1.96 * e;
  }
  std::printf("%d of %d rings of S(q) hold the truth\n", held, all);
  EXPECT_GT(all, 60);
  EXPECT_GE(held, int(0.85 * all));

  // g(r) at contact and at its first minimum, of the period.
  const auto g_at = [&](double r) {
    const auto& g = m.pair_correlation;
    for (size_t i = 0; i < g.x.size(); ++i)
      if (std::abs(g.x[i] - r) < 0.051) return std::pair(g.value[i], g.error[i]);
    return std::pair(-1.0, 0.0);
  };
  double pairs[2] = {};
  const double edges[2][2] = {{2.1, 2.2}, {3.5, 3.6}};
  for (size_t i = 0; i < discs.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      double dx = std::abs(discs[i].x - discs[j].x), dy = std::abs(discs[i].y - discs[j].y);
      dx = std::min(dx, side - dx), dy = std::min(dy, side - dy);
      const double r = std::hypot(dx, dy) / kRadius;
      for (int k = 0; k < 2; ++k) pairs[k] += r >= edges[k][0] && r < edges[k][1];
    }
  const double n = double(discs.size());
  for (int k = 0; k < 2; ++k) {
    const double ring = M_PI * kRadius * kRadius * (edges[k][1] * edges[k][1] - edges[k][0] * edges[k][0]);
    const double expected = 2 * pairs[k] / (n * n / (side * side) * ring);
    const auto [value, error] = g_at(0.5 * (edges[k][0] + edges[k][1]));
    std::printf("g(%.2f) %.3f +- %.3f, expected %.3f\n", 0.5 * (edges[k][0] + edges[k][1]), value, error,
                expected);
    EXPECT_NEAR(value, expected, 3 * error + 0.05 * expected);
  }
}

}  // namespace
}  // namespace aureole::test
