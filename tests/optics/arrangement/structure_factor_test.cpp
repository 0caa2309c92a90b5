// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/structure_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/optics/arrangement/equilibrium_structure_factor.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(HardDiscStructureFactor, CompressibilityLimit) {
  for (double fa : {0.0, 0.01, 0.1, 0.3, 0.5, 0.65, 0.7})
    EXPECT_NEAR(hard_disc_structure_factor(0, fa), std::pow(1 - fa, 3) / (1 + fa), 1e-14) << fa;
  EXPECT_EQ(hard_disc_structure_factor(1.7, 0), 1);
  EXPECT_NEAR(hard_disc_structure_factor(4000, 0.7), 1, 1e-4);
}

TEST(HardDiscStructureFactor, FirstPeaks) {
  const struct {
    double fa, u, height;
  } peaks[] = {{0.1, 2.613, 1.0621}, {0.3, 2.733, 1.2781}, {0.5, 2.918, 1.8544}, {0.7, 3.210, 6.503}};
  for (const auto& peak : peaks) {
    double best_u = 0, best = 0;
    for (double u = 2; u < 4; u += 1e-4)
      if (const double s = hard_disc_structure_factor(u, peak.fa); s > best) best = s, best_u = u;
    EXPECT_NEAR(best_u, peak.u, 6e-4);
    EXPECT_NEAR(best, peak.height, peak.fa == 0.7 ? 6e-4 : 6e-5);
  }
}

TEST(HardDiscStructureFactor, AlwaysPositive) {
  for (double fa = 0; fa <= 0.7; fa += 0.05)
    for (double u = 0; u < 60; u += 0.01) ASSERT_GT(hard_disc_structure_factor(u, fa), 0) << u << " " << fa;
}

/// 1 + rho0 integral of h(r) exp(-i q.r) d2r with h exact to first order in density: -1 for r < 2a,
/// then rho0 times the overlap of two exclusion discs of radius 2a (Hansen & McDonald, Theory of Simple
/// Liquids, 4th ed. 2013). Simpson's rule in units of a, Bessel function of the standard library.
double virial_structure_factor(double u, double fa) {
  const int cells = 4000;
  double inside = 0, outside = 0;
  for (int i = 0; i <= cells; ++i) {
    const double weight = (i == 0 || i == cells) ? 1 : (i % 2 ? 4 : 2);
    const double r1 = 2.0 * i / cells, r2 = 2 + 2.0 * i / cells;
    // The exclusion discs are at distance r2, their radius is 2.
    const double overlap =
        8 * std::acos(std::min(1.0, r2 / 4)) - r2 / 2 * std::sqrt(std::max(0.0, 16 - r2 * r2));
    inside -= weight * r1 * std::cyl_bessel_j(0.0, u * r1);
    outside += weight * r2 * std::cyl_bessel_j(0.0, u * r2) * fa / kPi * overlap;
  }
  return 1 + fa / kPi * 2 * kPi * (inside + outside) * 2 / cells / 3;
}

TEST(HardDiscStructureFactor, SmallDensityExpansion) {
  for (double fa : {0.001, 0.01, 0.03}) {
    double worst = 0;
    for (double u = 0; u < 15; u += 0.25)
      worst = std::max(worst, std::abs(hard_disc_structure_factor(u, fa) - virial_structure_factor(u, fa)));
    std::printf("area fraction %.3f: largest difference from the exact first order of g %.2e = %.2f Fa^2\n",
                fa, worst, worst / fa / fa);
    // Rosenfeld's equations are exact to order Fa. To order Fa^2 they have a third virial coefficient of 3
    // for the exact 4 x 0.782004; three times that is the difference at u = 0, 0.384 Fa^2, the largest.
    EXPECT_LT(worst, 0.39 * fa * fa) << fa;
  }
}

/// Hard discs of radius 1 in equilibrium: Metropolis moves in a periodic box, from a hexagonal lattice.
class HardDiscFluid {
public:
  explicit HardDiscFluid(double area_fraction) {
    const double spacing = std::sqrt(2 * kPi / (std::sqrt(3.0) * area_fraction));
    const int columns = 26, rows = 30;
    width_ = columns * spacing, height_ = rows * spacing * std::sqrt(3.0) / 2;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        discs.push_back({(column + 0.5 * (row % 2)) * spacing, row * spacing * std::sqrt(3.0) / 2});
    // Cells as wide as a disc: its neighbours are in 3 x 3 of them.
    nx_ = int(width_ / 2), ny_ = int(height_ / 2);
    cells_.resize(nx_ * ny_);
    for (int i = 0; i < int(discs.size()); ++i) cells_[cell(discs[i])].push_back(i);
  }

  void sweep(double step) {
    for (size_t n = 0; n < discs.size(); ++n) {
      const int i = int(uniform_(random_) * discs.size());
      std::array<double, 2> to = {discs[i][0] + step * (2 * uniform_(random_) - 1),
                                  discs[i][1] + step * (2 * uniform_(random_) - 1)};
      to = {to[0] - width_ * std::floor(to[0] / width_), to[1] - height_ * std::floor(to[1] / height_)};
      if (overlaps(i, to)) continue;
      std::erase(cells_[cell(discs[i])], i);
      discs[i] = to;
      cells_[cell(to)].push_back(i);
    }
  }

  double width() const { return width_; }
  double height() const { return height_; }
  std::vector<std::array<double, 2>> discs;

private:
  int cell(const std::array<double, 2>& p) const {
    return std::min(int(p[0] / width_ * nx_), nx_ - 1) + nx_ * std::min(int(p[1] / height_ * ny_), ny_ - 1);
  }

  bool overlaps(int self, const std::array<double, 2>& p) const {
    const int centre = cell(p), cx = centre % nx_, cy = centre / nx_;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        for (int j : cells_[(cx + dx + nx_) % nx_ + nx_ * ((cy + dy + ny_) % ny_)]) {
          const double x = std::remainder(p[0] - discs[j][0], width_);
          const double y = std::remainder(p[1] - discs[j][1], height_);
          if (j != self && x * x + y * y < 4) return true;
        }
    return false;
  }

  double width_, height_;
  int nx_, ny_;
  std::vector<std::vector<int>> cells_;
  std::mt19937_64 random_{20250701};
  std::uniform_real_distribution<double> uniform_;
};

TEST(HardDiscStructureFactor, EquilibriumSimulation) {
  const double fa = 0.3;
  HardDiscFluid fluid(fa);
  for (int i = 0; i < 600; ++i) fluid.sweep(1.2);

  const double targets[] = {0.5, 1.2, 2.0, 2.7, 3.5, 4.5, 6.0};
  struct Shell {
    std::vector<std::array<double, 2>> q;
    double sum = 0, expected = 0, equilibrium = 0;
  } shells[std::size(targets)];
  for (size_t k = 0; k < std::size(targets); ++k)
    for (int n = 0; n < 14; ++n) {  // wave vectors of the box spread over half a turn (-q repeats q)
      const double angle = kPi * (n + 0.3) / 14;
      const double x =
          2 * kPi / fluid.width() * std::round(targets[k] * std::cos(angle) * fluid.width() / 2 / kPi);
      const double y =
          2 * kPi / fluid.height() * std::round(targets[k] * std::sin(angle) * fluid.height() / 2 / kPi);
      shells[k].q.push_back({x, y});
      const double u = std::hypot(x, y);
      shells[k].expected += hard_disc_structure_factor(u, fa) / 14;
      shells[k].equilibrium += equilibrium_structure_factor(HardDiscWave(u), u, fa) / 14;
    }

  const int samples = 700;
  for (int sample = 0; sample < samples; ++sample) {
    for (int i = 0; i < 8; ++i) fluid.sweep(1.2);
    for (Shell& shell : shells)
      for (const auto& q : shell.q) {
        double re = 0, im = 0;
        for (const auto& p : fluid.discs) {
          const double phase = q[0] * p[0] + q[1] * p[1];
          re += std::cos(phase), im += std::sin(phase);
        }
        shell.sum += (re * re + im * im) / double(fluid.discs.size()) / (samples * 14.0);
      }
  }
  for (size_t k = 0; k < std::size(targets); ++k) {
    std::printf("qa %.1f: simulation %.4f, Percus-Yevick %.4f (%+.1f %%), equilibrium %+.1f %%\n", targets[k],
                shells[k].sum, shells[k].expected, 100 * (shells[k].expected / shells[k].sum - 1),
                100 * (shells[k].equilibrium / shells[k].sum - 1));
    EXPECT_NEAR(shells[k].sum / shells[k].equilibrium, 1, 0.04) << targets[k];
    EXPECT_NEAR(shells[k].sum / shells[k].expected, 1, 0.05) << targets[k];
  }
}

TEST(HardDiscStructureFactor, Errors) {
  for (double fa : {-0.01, 0.71, std::nan("")})
    EXPECT_THROW(hard_disc_structure_factor(1, fa), std::domain_error);
  try {
    hard_disc_structure_factor(1, 0.8);
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("0.8"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace aureole::optics
