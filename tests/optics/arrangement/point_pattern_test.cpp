// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/point_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "aureole/optics/arrangement/hard_discs.h"
#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

PointPattern random_points(int n, double width, double height, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform;
  PointPattern p{width, height, {}, {}};
  for (int i = 0; i < n; ++i) p.x.push_back(width * uniform(random)), p.y.push_back(height * uniform(random));
  return p;
}

/// Windows cut out of a periodic box of hard discs.
std::vector<PointPattern> micrographs(double fa, int fields, std::uint64_t seed) {
  HardDiscSimulation simulation(1600, fa, seed);
  simulation.advance(simulation.equilibration_sweeps());
  std::vector<PointPattern> all;
  const HardDiscs& d = simulation.state();
  for (int f = 0; f < fields; ++f) {
    simulation.advance(40);
    PointPattern p{0.7 * d.box_x, 0.6 * d.box_y, {}, {}};
    for (int i = 0; i < d.size(); ++i)
      if (d.x[i] <= p.width && d.y[i] <= p.height) p.x.push_back(d.x[i]), p.y.push_back(d.y[i]);
    all.push_back(p);
  }
  return all;
}

TEST(PointPattern, RandomPointsAreUncorrelated) {
  std::mt19937_64 random(3);
  std::vector<double> q, edges;
  for (double v = 0.3; v < 6; v += 0.4) q.push_back(v);
  for (double r = 0; r <= 20; r += 1) edges.push_back(r);
  double chi_s = 0, chi_g = 0, n_s = 0, n_g = 0;
  for (int run = 0; run < 30; ++run) {
    const std::vector<PointPattern> one = {random_points(400, 90, 60, random)};
    for (const Estimate& s : window_structure_factor(one, q))
      chi_s += (s.mean - 1) * (s.mean - 1) / (s.error * s.error), n_s += 1;
    for (const Estimate& g : window_pair_correlation(one, edges)) {
      if (g.error == 0) continue;  // an empty bin
      chi_g += (g.mean - 1) * (g.mean - 1) / (g.error * g.error), n_g += 1;
    }
  }
  std::printf("random points: chi2 of S %.2f, of g %.2f\n", chi_s / n_s, chi_g / n_g);
  EXPECT_GT(chi_s / n_s, 0.6);
  EXPECT_LT(chi_s / n_s, 1.6);
  EXPECT_GT(n_g, 500);
  EXPECT_GT(chi_g / n_g, 0.6);
  EXPECT_LT(chi_g / n_g, 1.8);
}

TEST(PointPattern, EdgeCorrectionIsUnbiased) {
  // Far apart points of small windows: without the correction g would fall to 0.6 at half of the side.
  std::mt19937_64 random(4);
  std::vector<PointPattern> fields;
  for (int i = 0; i < 300; ++i) fields.push_back(random_points(60, 10, 10, random));
  const auto g = window_pair_correlation(fields, {0.5, 2, 3, 4, 5}, 1);
  for (const Estimate& e : g) EXPECT_NEAR(e.mean, 1, std::min(4.5 * e.error, 0.03));
}

TEST(PointPattern, HardDiscsInAWindow) {
  const double fa = 0.4;
  const auto fields = micrographs(fa, 6, 5);
  std::vector<double> q;
  for (double v = 0.4; v < 8; v += 0.2) q.push_back(v);
  const auto s = window_structure_factor(fields, q);
  double chi = 0, worst = 0;
  for (size_t k = 0; k < q.size(); ++k) {
    // Percus-Yevick is within 3 % here.
    const double theory = hard_disc_structure_factor(q[k], fa);
    const double error = std::hypot(s[k].error, 0.03 * theory);
    chi += (s[k].mean - theory) * (s[k].mean - theory) / (error * error) / double(q.size());
    if (q[k] > 1.5) worst = std::max(worst, std::abs(s[k].mean / theory - 1));
  }
  std::printf("hard discs in 6 windows: chi2 %.2f, worst beyond q = 1.5 %.1f %%\n", chi, 100 * worst);
  EXPECT_LT(chi, 1.8);
  EXPECT_LT(worst, 0.2);

  const auto g = window_pair_correlation(fields, {0, 1.999, 2.1, 3.1, 3.5, 4.5, 10});
  EXPECT_EQ(g[0].mean, 0);
  const double contact = hard_disc_contact_value(fa);
  EXPECT_GT(g[1].mean, 0.8 * contact);
  EXPECT_LT(g[1].mean, contact);
  EXPECT_NEAR(g[5].mean, 1, 0.02);
  EXPECT_LT(g[1].error, 0.1 * g[1].mean);
}

TEST(PointPattern, ErrorsAreHonest) {
  // Estimates of single fields scatter about their mean by their stated errors.
  const auto fields = micrographs(0.5, 24, 6);
  const std::vector<double> q = {0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6};
  const std::vector<double> edges = {2, 2.2, 2.6, 3.2, 4, 5, 6};
  std::vector<std::vector<Estimate>> s, g;
  for (const PointPattern& f : fields) {
    s.push_back(window_structure_factor({f}, q));
    g.push_back(window_pair_correlation({f}, edges, 4));
  }
  const auto chi = [](const std::vector<std::vector<Estimate>>& runs) {
    double sum = 0;
    for (size_t k = 0; k < runs[0].size(); ++k) {
      double mean = 0, squares = 0, variance = 0;
      for (const auto& r : runs) mean += r[k].mean / double(runs.size());
      for (const auto& r : runs) {
        squares += (r[k].mean - mean) * (r[k].mean - mean) / double(runs.size() - 1);
        variance += r[k].error * r[k].error / double(runs.size());
      }
      sum += squares / variance / double(runs[0].size());
    }
    return sum;
  };
  std::printf("scatter of fields over stated error: chi2 of S %.2f, of g %.2f\n", chi(s), chi(g));
  EXPECT_GT(chi(s), 0.5);
  EXPECT_LT(chi(s), 2);
  // The jackknife takes the tiles for independent; discs that repel across their borders make its error too
  // large, on the safe side.
  EXPECT_GT(chi(g), 0.3);
  EXPECT_LT(chi(g), 2);
}

TEST(PointPattern, SquareLattice) {
  PointPattern p{60, 60, {}, {}};
  for (int i = 0; i < 900; ++i) p.x.push_back(2 * (i % 30) + 1), p.y.push_back(2 * (i / 30) + 1);
  const auto s = window_structure_factor({p}, {0.5 * kPi, kPi, 1.2 * kPi, std::sqrt(2.0) * kPi}, 4000);
  EXPECT_LT(s[0].mean, 1e-3);
  EXPECT_LT(s[2].mean, 1e-3);
  // A Bragg peak at each axis (2 of the half turn) and each diagonal, height N (2/3)^4 4, seen under its
  // width.
  EXPECT_GT(s[1].mean, 3);
  EXPECT_GT(s[3].mean, 3);
  const auto g = window_pair_correlation({p}, {0, 1.9, 2.1, 2.7, 2.9, 3.9, 4.1}, 3);
  for (const int empty : {0, 2, 4}) EXPECT_EQ(g[empty].mean, 0);
  const auto neighbours = [&](int bin, double a, double b) {
    return g[bin].mean * kPi * (b * b - a * a) * 899 / 3600;
  };
  EXPECT_NEAR(neighbours(1, 1.9, 2.1), 4, 0.02);
  EXPECT_NEAR(neighbours(3, 2.7, 2.9), 4, 0.02);
  EXPECT_NEAR(neighbours(5, 3.9, 4.1), 4, 0.02);
}

TEST(PointPattern, Errors) {
  std::mt19937_64 random(3);
  const PointPattern good = random_points(50, 10, 20, random);
  EXPECT_NEAR(smallest_wave(good), 4 * kPi / 10, 1e-12);
  EXPECT_THROW(window_structure_factor({}, {5}), std::domain_error);
  EXPECT_THROW(window_structure_factor({good}, {0.1}), std::domain_error);
  EXPECT_THROW(window_structure_factor({good}, {std::nan("")}), std::domain_error);
  EXPECT_THROW(window_structure_factor({good}, {5}, 1), std::domain_error);
  EXPECT_THROW(window_pair_correlation({good}, {1, 6}), std::domain_error);
  EXPECT_THROW(window_pair_correlation({good}, {2, 1}), std::domain_error);
  EXPECT_THROW(window_pair_correlation({good}, {1, 2}, 1), std::domain_error);
  PointPattern outside = good, lone = good, flat = good;
  outside.x[7] = 11;
  EXPECT_THROW(window_structure_factor({outside}, {5}), std::domain_error);
  outside.x[7] = std::nan("");
  EXPECT_THROW(window_structure_factor({outside}, {5}), std::domain_error);
  lone.x.resize(1), lone.y.resize(1);
  EXPECT_THROW(window_pair_correlation({lone}, {1, 2}), std::domain_error);
  flat.height = 0;
  EXPECT_THROW(window_pair_correlation({flat}, {1, 2}), std::domain_error);
  PointPattern edge{10, 10, {0, 10, 0}, {0, 0, 10}};
  EXPECT_THROW(window_structure_factor({edge}, {5}), std::domain_error);  // the taper leaves nothing
}

}  // namespace
}  // namespace aureole::optics
