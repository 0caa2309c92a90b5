// SPDX-License-Identifier: Apache-2.0
// The sky model against values that Mitsuba 3.9.1's `sunsky` prints (variant scalar_spectral), and its own
// properties.
#include "aureole/optics/sky/sky_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aureole::optics {
namespace {

std::array<double, SkyModel::kChannels> grey(double albedo) {
  std::array<double, SkyModel::kChannels> a;
  a.fill(albedo);
  return a;
}

/// Linear between the channels, as Mitsuba evaluates it.
template <class F>
double between(double nm, F&& f) {
  const std::size_t c = std::size_t((nm - 320) / 40);
  const double t = (nm - SkyModel::wavelength_nm(c)) / 40;
  return (1 - t) * f(c) + t * f(c + 1);
}

// sun_direction (1, 0, 1), turbidity 3.5, albedo 0.4, complex_sun.
constexpr double kNm[] = {360, 440, 550, 710};

TEST(SkyModel, AgreesWithMitsuba) {
  const SkyModel model(3.5, grey(0.4), M_PI / 4);
  const struct {
    double x, y, z;
    double expected[4];
  } values[] = {{1, 0, 1, {0.134129, 0.300277, 0.271479, 0.166564}},
                {0, 0, 1, {0.072169, 0.0960528, 0.0469883, 0.0170396}},
                {-1, 0, 1, {0.0768821, 0.112307, 0.0526389, 0.0160081}},
                {0, 1, 0.02, {0.0843111, 0.207376, 0.183276, 0.093537}},
                {1, 0.3, 0.9, {0.126522, 0.260958, 0.206648, 0.117896}}};
  for (const auto& v : values) {
    const double l = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    const double gamma = std::acos(std::min(1.0, (v.x + v.z) / (l * std::sqrt(2.0))));
    for (int k = 0; k < 4; ++k) {
      const double found = between(kNm[k], [&](std::size_t c) { return model.sky(c, v.z / l, gamma); });
      EXPECT_NEAR(found / v.expected[k], 1, 2e-4) << v.x << " " << v.y << " " << kNm[k];
    }
  }
}

TEST(SkyModel, SunAgreesWithMitsuba) {
  const SkyModel model(3.5, grey(0.4), M_PI / 4);
  const struct {
    double above;  ///< the middle [rad]
    double expected[4];
  } values[] = {{0, {4382.86, 16166.5, 20423.7, 18096.5}},
                {0.002, {4091.42, 15124.7, 19381.6, 17388.2}},
                {-0.002, {4074.37, 15094.4, 19362.9, 17380.2}},
                {0.004, {2750.95, 10541.7, 14712.6, 14133.1}}};
  for (const auto& v : values) {
    const double q = std::sin(v.above) / std::sin(SkyModel::kSunDiameter / 2), cosine = std::sqrt(1 - q * q);
    for (int k = 0; k < 4; ++k) {
      const double found =
          between(kNm[k], [&](std::size_t c) { return model.sun(c, M_PI / 4 + v.above); }) *
          between(kNm[k], [&](std::size_t c) { return SkyModel::limb_darkening(c, cosine); });
      EXPECT_NEAR(found / v.expected[k], 1, 1e-3) << v.above << " " << kNm[k];
    }
  }
}

TEST(SkyModel, ProductIsTheSky) {
  const SkyModel model(6.2, grey(0.1), 0.2);
  for (const double z : {0.0, 0.01, 0.5, 1.0})
    for (const double gamma : {0.0, 0.3, 3.0})
      EXPECT_DOUBLE_EQ(model.sky(4, z, gamma),
                       model.horizon(4, z) * (model.glow(4, gamma) + model.zenith_gain(4) * std::sqrt(z)));
}

TEST(SkyModel, IsContinuousAndHardlyNegative) {
  double worst_share = 0;
  for (double turbidity = 1; turbidity <= 10; turbidity += 0.45)
    for (const double albedo : {0.0, 0.5, 1.0})
      for (const double elevation : {0.0, 0.001, 0.05, 0.3, 1.0, M_PI / 2}) {
        const SkyModel model(turbidity, grey(albedo), elevation);
        const SkyModel moved(turbidity + 1e-6, grey(albedo), elevation + 1e-9);
        for (std::size_t c = 1; c < SkyModel::kChannels; ++c) {
          double positive = 0, negative = 0;
          for (double z = 0.005; z < 1; z += 0.01)
            for (double gamma = 0; gamma <= M_PI; gamma += 0.1) {
              // Only angles to the sun that exist at this angle to the zenith.
              const double zenith = std::acos(z), sun = M_PI / 2 - elevation;
              if (gamma < std::abs(zenith - sun) || gamma > zenith + sun) continue;
              const double l = model.sky(c, z, gamma);
              ASSERT_TRUE(std::isfinite(l));
              (l < 0 ? negative : positive) += std::abs(l);
              // The cube root of the elevation has an infinite slope at the horizon.
              if (elevation > 0) {
                EXPECT_NEAR(moved.sky(c, z, gamma), l, 1e-3 * std::abs(l) + 1e-5);
              }
            }
          worst_share = std::max(worst_share, negative / positive);
          const double sun = model.sun(c, elevation);
          EXPECT_GE(sun, 0);
          if (elevation > 0) {
            EXPECT_NEAR(moved.sun(c, elevation), sun, 1e-4 * sun + 1e-6);
          }
        }
      }
  RecordProperty("negative_share_ppm", int(1e6 * worst_share));
  EXPECT_LT(worst_share, 2e-3);
}

TEST(SkyModel, SunIsDarkerAndRedderNearTheHorizon) {
  const SkyModel model(3, grey(0.2), 0.5);
  EXPECT_EQ(model.sun(5, -1e-9), 0);
  double before = 0;
  for (double elevation = 0.02; elevation < 1.5; elevation += 0.02) {
    const double l = model.sun(5, elevation);
    EXPECT_GT(l, before) << elevation;
    before = l;
  }
  EXPECT_GT(model.sun(10, 0.05) / model.sun(2, 0.05), 2 * model.sun(10, 1.0) / model.sun(2, 1.0));
  for (std::size_t c = 0; c < SkyModel::kChannels; ++c) {
    EXPECT_NEAR(SkyModel::limb_darkening(c, 1), 1, 2e-3);
    EXPECT_LT(SkyModel::limb_darkening(c, 0.2), SkyModel::limb_darkening(c, 0.8));
  }
  // Blue darkens more.
  EXPECT_LT(SkyModel::limb_darkening(2, 0.3), SkyModel::limb_darkening(9, 0.3));
}

}  // namespace
}  // namespace aureole::optics
