// SPDX-License-Identifier: Apache-2.0
// Pictures of discs whose places and sizes are known: what comes out must be what went in.
#include "aureole/instrument/microstructure.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "aureole/core/error.h"
#include "aureole/optics/structure_factor.h"
#include "instrument/disc_pictures.h"

namespace aureole::test {
namespace {

Microstructure analyse(const std::vector<Micrograph>& fields, const MicrostructureOptions& options = {}) {
  return analyse_microstructure(
      fields.size(), [&](size_t i) { return fields[i]; }, options, nullptr);
}

struct Case {
  const char* name;
  double area_fraction, radius;
  int fields, size;
  PictureOptions picture;
};

PictureOptions with(bool bright, int levels, double noise = 0.04, double blur = 1, double shading = 0.3) {
  PictureOptions p;
  p.bright = bright, p.levels = levels, p.noise = noise, p.blur = blur, p.shading = shading;
  return p;
}

const Case kCases[] = {
    {"thin_dark_8", 0.2, 9, 1, 700, with(false, 255)},
    {"thin_bright_16", 0.2, 9, 3, 400, with(true, 65535)},
    {"middle_dark_16", 0.4, 9, 1, 700, with(false, 65535)},
    {"middle_bright_8", 0.4, 8, 4, 350, with(true, 255)},
    {"dense_dark_8", 0.55, 9, 1, 700, with(false, 255)},
    {"dense_bright_16", 0.55, 9, 2, 500, with(true, 65535)},
    {"dense_blurred", 0.55, 12, 1, 800, with(false, 255, 0.04, 1.8)},
    {"small_discs", 0.4, 5, 1, 500, with(false, 255, 0.03, 0.8)},
    {"large_discs", 0.4, 30, 4, 800, with(false, 255)},
    {"noisy", 0.4, 9, 1, 700, with(false, 255, 0.2)},
    {"strong_shading", 0.4, 9, 1, 700, with(true, 65535, 0.04, 1, 0.7)},
};

class HardDiscs : public ::testing::TestWithParam<Case> {};

TEST_P(HardDiscs, AreFoundAgain) {
  const Case& c = GetParam();
  std::vector<Micrograph> fields;
  for (int f = 0; f < c.fields; ++f) {
    double side = 0;
    const double wanted = 1.3 * c.size * c.size * c.area_fraction / (M_PI * c.radius * c.radius);
    const auto discs =
        hard_discs(c.area_fraction, c.radius, side, std::max(int(wanted), 60), 11 + unsigned(f));
    PictureOptions p = c.picture;
    p.width = p.height = c.size, p.seed = 3 + unsigned(f);
    fields.push_back(picture_of(discs, side, p));
  }
  const Microstructure m = analyse(fields);
  const double um = 1e-6, pixel = 0.2 * um,
               density = c.area_fraction / (M_PI * std::pow(c.radius * pixel, 2));
  std::printf(
      "%-16s Fa %.2f: Fa %.4f [%.4f %.4f] Fr %.4f [%.4f %.4f] r %+.2f %% sd %.2f %% a %+.2f %% density %+.2f "
      "%% circ %.3f asp %.3f pol %.2f blur %.2f n %zu\n",
      c.name, c.area_fraction, m.area_fraction.value, m.area_fraction.low, m.area_fraction.high,
      m.shape_fraction.value, m.shape_fraction.low, m.shape_fraction.high,
      100 * (m.mean_radius.value / (c.radius * pixel) - 1), 100 * m.deviation.value / m.mean_radius.value,
      100 * (m.correlation_radius.value / (c.radius * pixel) - 1), 100 * (m.density.value / density - 1),
      m.circularity, m.aspect, m.fields[0].polarity_score, m.fields[0].blur, m.particles.size());
  EXPECT_EQ(m.fields[0].bright, c.picture.bright);
  EXPECT_NEAR(m.mean_radius.value, c.radius * pixel, 0.03 * c.radius * pixel);
  EXPECT_TRUE(m.round);
}

INSTANTIATE_TEST_SUITE_P(Microstructure, HardDiscs, ::testing::ValuesIn(kCases),
                         [](const auto& i) { return i.param.name; });

}  // namespace
}  // namespace aureole::test
