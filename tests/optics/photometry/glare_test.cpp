// SPDX-License-Identifier: Apache-2.0
// Glare and mesopic vision against values of their definitions.
#include "aureole/optics/photometry/glare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace aureole::optics {
namespace {

TEST(Glare, UnifiedRatingOfOneSource) {
  // 8 lg(0.25/50 x 1e8 x 0.01) = 8 lg 5000.
  EXPECT_NEAR(unified_glare_rating(50, std::vector<GlareSource>{{1e4, 0.01, 1}}), 29.5918, 5e-5);
  // Twice the sources: 8 lg 2 more; a position index of 2: 8 lg 4 less.
  EXPECT_NEAR(unified_glare_rating(50, std::vector<GlareSource>{{1e4, 0.01, 1}, {1e4, 0.01, 1}}),
              29.5918 + 2.40824, 1e-4);
  EXPECT_NEAR(unified_glare_rating(50, std::vector<GlareSource>{{1e4, 0.01, 2}}), 29.5918 - 4.81648, 1e-4);
  EXPECT_TRUE(std::isinf(unified_glare_rating(50, {})));
  EXPECT_THROW(unified_glare_rating(0, {}), std::domain_error);
  EXPECT_THROW(unified_glare_rating(50, std::vector<GlareSource>{{-1, 0.01, 1}}), std::domain_error);
}

TEST(Glare, PositionIndex) {
  EXPECT_NEAR(position_index(0, 0), 1, 1e-12);
  // Straight above by 30 degrees: exp(0.0352 x 30 - 0.00122 x 30 + 2.1e-4 x 900).
  EXPECT_NEAR(position_index(M_PI / 6, 0), std::exp((35.2 - 1.22) * 1e-3 * 30 + 21e-5 * 900), 1e-9);
  // CIE 117, table 1: H/R = 0.5, T/R = 0 has 2.86; H/R = 0, T/R = 0.5 has 1.46.
  EXPECT_NEAR(position_index(std::atan(0.5), 0), 2.86, 0.1);
  EXPECT_NEAR(position_index(0, std::atan(0.5)), 1.46, 0.15);
  // Below the line of sight: 1 + 0.8 R/D up to R/D = 0.6, and 1 + 1.2 R/D beyond.
  EXPECT_NEAR(position_index(-std::atan(0.5), 0), 1.4, 1e-12);
  EXPECT_NEAR(position_index(-std::atan(1.0), 0), 2.2, 1e-12);
  EXPECT_EQ(position_index(0.1, 3), 16);
  double before = 1;
  for (int i = 1; i < 60; ++i) {
    const double p = position_index(i * M_PI / 180, 0.3);
    EXPECT_GE(p, before * (1 - 1e-12)) << i;
    before = p;
  }
}

TEST(Mesopic, Mes2) {
  EXPECT_NEAR(mesopic_luminance(0.1, 2).luminance, 0.13096, 5e-6);
  // By its own definition: m follows from the luminance, and the luminance from m.
  for (const double photopic : {0.006, 0.03, 0.3, 3.0})
    for (const double ratio : {0.25, 1.0, 2.65}) {
      const MesopicLuminance l = mesopic_luminance(photopic, ratio);
      EXPECT_NEAR(l.m, std::clamp(0.767 + 0.3334 * std::log10(l.luminance), 0.0, 1.0), 1e-9);
      if (ratio == 1) {
        EXPECT_NEAR(l.luminance, photopic, 1e-12);
      }
    }
  EXPECT_NEAR(mesopic_luminance(10, 2).luminance, 10, 1e-9);  // photopic vision
}

}  // namespace
}  // namespace aureole::optics
