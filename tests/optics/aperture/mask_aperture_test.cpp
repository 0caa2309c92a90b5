// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/aperture/mask_aperture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "aureole/optics/aperture/polygon_aperture.h"
#include "optics/aperture/polygon_test_support.h"

namespace aureole::optics {
namespace {

/// The sum that the mask's transform is defined by, about the centre of the picture.
std::complex<double> direct_transform(const Mask& m, double pitch, double qx, double qy) {
  std::complex<double> sum = 0;
  for (int y = 0; y < m.height; ++y)
    for (int x = 0; x < m.width; ++x)
      sum += double(m.at(x, y)) *
             testing::interval_transform(pitch * (x - 0.5 * m.width), pitch * (x + 1 - 0.5 * m.width), qx) *
             testing::interval_transform(pitch * (0.5 * m.height - y - 1), pitch * (0.5 * m.height - y), qy);
  return sum;
}

Mask random_mask(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit;
  Mask m{width, height, {}};
  for (int i = 0; i < width * height; ++i) m.open.push_back(unit(random) < 0.5f ? 0.f : unit(random));
  return m;
}

TEST(MaskAperture, IsTheSumOverPixels) {
  const double pitch = 0.25;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> q(-std::numbers::pi / pitch, std::numbers::pi / pitch);
  for (auto [width, height] : {std::pair(1, 1), {2, 3}, {17, 40}, {64, 64}, {301, 200}}) {
    const Mask m = random_mask(width, height, 3);
    if (m.open[0] == 0 && width == 1) continue;
    const MaskAperture a(m, pitch, false);
    double area = 0, area2 = 0;
    for (float v : m.open) area += v, area2 += v * v;
    EXPECT_NEAR(a.area(), area * pitch * pitch, 1e-9 * area);
    EXPECT_NEAR(a.squared_area(), area2 * pitch * pitch, 1e-9 * area);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      // Some q lie beyond the Nyquist frequency, where the sum is periodic under the envelope of a pixel.
      const double scale = i < 40 ? 1 : 5, qx = i == 0 ? 0 : scale * q(random),
                   qy = i < 2 ? 0 : scale * q(random);
      worst = std::max(worst, std::abs(a.transform(qx, qy) - direct_transform(m, pitch, qx, qy)) / a.area());
    }
    EXPECT_LT(worst, 1e-4) << width << " x " << height;
    EXPECT_NEAR(std::abs(a.transform(0, 0) / a.area() - 1.0), 0, 1e-4);
    EXPECT_LT(std::abs(a.transform(3, -2) - std::conj(a.transform(-3, 2))), 1e-12 * a.area());
  }
}

TEST(MaskAperture, LargeMasks) {
  const Mask m = random_mask(1024, 1000, 9);
  const MaskAperture a(m, 1, false);
  for (auto [qx, qy] : {std::pair(0.01, 0.0), {0.1, -0.5}, {-3.0, 3.1}, {3.14159, 1.0}})
    EXPECT_LT(std::abs(a.transform(qx, qy) - direct_transform(m, 1, qx, qy)) / a.area(), 1e-4);
}

/// Part of every pixel that is in the polygon.
Mask rasterised(const std::vector<Ring>& rings, int n, double pitch) {
  constexpr int kSub = 16;
  Mask m{n, n, std::vector<float>(std::size_t(n) * n)};
  for (int row = 0; row < n * kSub; ++row) {
    const double y = pitch * (0.5 * n - (row + 0.5) / kSub);
    for (int column = 0; column < n * kSub; ++column) {
      const double x = pitch * ((column + 0.5) / kSub - 0.5 * n);
      bool inside = false;
      for (const Ring& r : rings)
        for (std::size_t i = 0; i < r.size(); ++i) {
          const PlanePoint a = r[i], b = r[(i + 1) % r.size()];
          if ((a.y <= y) != (b.y <= y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
        }
      m.at(column / kSub, row / kSub) += inside ? 1.f / (kSub * kSub) : 0;
    }
  }
  return m;
}

TEST(MaskAperture, IsThePolygonThatItDraws) {
  const std::vector<Ring> rings = {{{-1.2, -0.9}, {1.3, -0.4}, {0.5, 0.3}, {0.2, 1.4}},
                                   testing::regular_ring(4, 0.3, 0.4)};
  const int n = 96;
  const double pitch = 3.0 / n;
  const Mask m = rasterised(rings, n, pitch);
  const PolygonRegion region = PolygonRegion::even_odd(rings);
  const PolygonAperture about_picture(region), about_centroid(region.placed(region.centroid(), 1));
  const MaskAperture mask(m, pitch, false), centred(m, pitch, true);
  EXPECT_NEAR(mask.area(), region.area(), 1e-3 * region.area());
  EXPECT_LT(mask.squared_area(), mask.area());
  EXPECT_NEAR(mask.bounding_radius(), about_picture.bounding_radius(), 2 * pitch);
  EXPECT_NEAR(centred.bounding_radius(), about_centroid.bounding_radius(), 2 * pitch);
  for (double q : {0.0, 0.5, 2.0, 5.0, 12.0, 25.0})
    for (double phi : {0.0, 0.7, 1.6, 3.0, 5.0}) {
      const double x = q * std::cos(phi), y = q * std::sin(phi);
      EXPECT_LT(std::abs(mask.transform(x, y) - about_picture.transform(x, y)), 0.01 * region.area());
      EXPECT_LT(std::abs(centred.transform(x, y) - about_centroid.transform(x, y)), 0.01 * region.area());
    }
}

TEST(MaskAperture, ParsevalsTheorem) {
  const Mask m = random_mask(6, 5, 11);
  const MaskAperture a(m, 1, true);
  const double most = 40;
  const int rings = 640, angles = 1024;
  double sum = 0, jumps = 0;
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < angles; ++k) {
      const double q = most * (i + 0.5) / rings, phi = std::numbers::pi * (k + 0.3) / angles;
      sum += q * std::norm(a.transform(q * std::cos(phi), q * std::sin(phi)));
    }
  sum *= most / rings / angles / (2 * std::numbers::pi);
  // Beyond `most`, Porod's law: every edge between pixels counts with the square of its jump.
  const auto value = [&](int x, int y) { return x < 0 || y < 0 || x >= 6 || y >= 5 ? 0.f : m.at(x, y); };
  for (int y = -1; y < 5; ++y)
    for (int x = -1; x < 6; ++x)
      jumps += std::pow(value(x + 1, y) - value(x, y), 2) + std::pow(value(x, y + 1) - value(x, y), 2);
  EXPECT_NEAR(sum + jumps / (std::numbers::pi * most), a.squared_area(), 1e-3 * a.squared_area());
  EXPECT_LT(a.squared_area(), 0.8 * a.area());
}

TEST(MaskAperture, BorderDoesNotCountAndLargePicturesAreAveraged) {
  // One bright square in a picture of 3000 x 2600, larger than the limit when cropped.
  Mask m{3000, 2600, std::vector<float>(3000 * 2600)};
  for (int y = 100; y < 2500; ++y)
    for (int x = 200; x < 2600; ++x) m.at(x, y) = 1;
  const MaskAperture a(m, 1e-3, false);
  const PolygonAperture square(
      PolygonRegion::even_odd({{{-1.3, -1.2}, {1.1, -1.2}, {1.1, 1.2}, {-1.3, 1.2}}}));
  EXPECT_NEAR(a.area(), square.area(), 1e-5);
  for (double q : {0.3, 3.0, 30.0, 100.0})
    EXPECT_LT(std::abs(a.transform(q, 0.4 * q) - square.transform(q, 0.4 * q)), 1e-4 * square.area()) << q;
}

TEST(MaskAperture, Errors) {
  EXPECT_THROW(MaskAperture(Mask{2, 2, {0, 0, 0, 0}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{0, 0, {}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{1, 1, {1.5f}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{1, 1, {-0.1f}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{1, 1, {std::nanf("")}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{2, 1, {1}}, 1, true), std::domain_error);
  EXPECT_THROW(MaskAperture(Mask{1, 1, {1}}, 0, true), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
