// SPDX-License-Identifier: Apache-2.0
// Exchange areas against quadrature and published view factors, and interreflection in a box against published transfer factors.
#include "aureole/optics/photometry/box_radiosity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole::optics {
namespace {

/// The exchange area of two rectangles by midpoints of both. `kernel` takes a point of each, in their own coordinates.
template <class Kernel>
double exchange_by_midpoints(Interval a, Interval b, Interval c, Interval d, const Kernel& kernel) {
  constexpr int kSide = 28;
  const auto at = [](const Interval& v, int i) { return v.low + (v.high - v.low) * (i + 0.5) / kSide; };
  double sum = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k)
        for (int l = 0; l < kSide; ++l) sum += kernel(at(a, i), at(b, j), at(c, k), at(d, l));
  return sum * (a.high - a.low) * (b.high - b.low) * (c.high - c.low) * (d.high - d.low) / std::pow(kSide, 4);
}

TEST(BoxRadiosity, ExchangeAreasByQuadrature) {
  const Interval unit{0, 1};
  // J. R. Howell's catalogue of view factors: opposite faces of a cube, and faces that share an edge.
  EXPECT_NEAR(parallel_exchange(unit, unit, unit, unit, 1), 0.19982, 5e-6);
  EXPECT_NEAR(perpendicular_exchange(unit, unit, unit, unit), 0.20004, 5e-6);

  const Interval x1{-0.3, 0.9}, y1{0.2, 1}, x2{0.5, 2.1}, y2{-1, 0.4};
  const double parallel = exchange_by_midpoints(x1, y1, x2, y2, [](double x, double y, double u, double v) {
    const double square = (x - u) * (x - u) + (y - v) * (y - v) + 1.3 * 1.3;
    return 1.3 * 1.3 / (M_PI * square * square);
  });
  EXPECT_NEAR(parallel_exchange(x1, y1, x2, y2, 1.3), parallel, 3e-4 * parallel);
  EXPECT_NEAR(parallel_exchange(x2, y2, x1, y1, 1.3), parallel, 3e-4 * parallel);

  const Interval x{0.4, 1.5}, z{0.3, 2};
  const double across = exchange_by_midpoints(x, y1, z, y2, [](double u, double y, double w, double v) {
    const double square = u * u + w * w + (y - v) * (y - v);
    return u * w / (M_PI * square * square);
  });
  EXPECT_NEAR(perpendicular_exchange(x, y1, z, y2), across, 3e-4 * across);
}

TEST(BoxRadiosity, EachZoneSeesTheWholeBox) {
  for (const BoxRadiosity& box : {BoxRadiosity::of_surfaces(4, 6, 2), BoxRadiosity::of_patches(4, 6, 2, 0.7)})
    for (std::size_t i = 0; i < box.size(); ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < box.size(); ++j) {
        EXPECT_GE(box.exchange(i, j), -1e-14);
        sum += box.exchange(i, j);
      }
      EXPECT_NEAR(sum, box.area(i), 1e-10 * box.area(i)) << i << " of " << box.size();
    }
  EXPECT_EQ(BoxRadiosity::of_patches(4, 6, 2, 0.7).size(), 2u * (6 * 9) + 2 * (9 * 3) + 2 * (6 * 3));
}

TEST(BoxRadiosity, TransferFactorsOfCie190) {
  // CIE 190:2010, table 5: the flux on the walls, direct light on them left out, by direct flux on floor, walls and ceiling.
  const struct {
    double x, y;
    std::array<double, 3> reflectances;  // floor, ceiling, walls
    double floor, walls, ceiling;
  } cases[] = {{4, 4, {0.2, 0.7, 0.5}, 0.220, 0.422, 0.646},
               {8, 16, {0.2, 0.7, 0.5}, 0.115, 0.211, 0.307},
               {8, 24, {0.2, 0.5, 0.3}, 0.085, 0.094, 0.179},
               {24, 16, {0.2, 0.3, 0.3}, 0.049, 0.059, 0.069}};
  for (const auto& c : cases) {
    const BoxRadiosity box = BoxRadiosity::of_surfaces(c.x, c.y, 2);
    EXPECT_NEAR(box.incident({1, 0, 0}, c.reflectances)[2], c.floor, 1.5e-3);
    EXPECT_NEAR(box.incident({0, 1, 0}, c.reflectances)[2], c.ceiling, 1.5e-3);
    EXPECT_NEAR(box.incident({0, 0, 1}, c.reflectances)[2] - 1, c.walls, 1.5e-3);
  }
}

TEST(BoxRadiosity, WhatComesInIsAbsorbed) {
  const BoxRadiosity box = BoxRadiosity::of_patches(3, 2, 2.5, 0.5);
  const std::array<double, 3> rho{0.2, 0.9, 0.6};
  std::vector<double> direct(box.size());
  direct[3] = 5, direct[40] = 2, direct.back() = 1;
  const std::vector<double> flux = box.incident(direct, rho);
  double absorbed = 0;
  for (std::size_t i = 0; i < box.size(); ++i) absorbed += (1 - rho[std::size_t(box.surface(i))]) * flux[i];
  EXPECT_NEAR(absorbed, 8, 1e-9);
  // Black walls: direct light alone.
  EXPECT_EQ(box.incident(direct, {0, 0, 0}), direct);
  EXPECT_THROW(box.incident(direct, {0.2, 1, 0.5}), std::domain_error);
  EXPECT_THROW(box.incident({1, 2}, rho), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
