// SPDX-License-Identifier: Apache-2.0
// Real pictures (sources in data/README.md) against counts by eye and numbers published with them. No
// parameter is fitted to a picture: options are given only for facts that one sees without measuring, such as
// that bubbles are dark and have glints in them, or the size below which specks are dirt.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "aureole/instrument/microscopy/microstructure.h"
#include "harness/paths.h"

namespace aureole::test {
namespace {

Microstructure analyse(const char* file, const MicrographOptions& reading,
                       const SegmentationOptions& segmentation) {
  MicrostructureOptions options;
  options.segmentation = segmentation;
  const Micrograph field = read_micrograph(source_dir() / "tests/instrument/data" / file, reading);
  const Microstructure m = analyse_microstructure(
      1, [&](size_t) { return field; }, options, nullptr);
  std::printf("%s: %d whole, %d cut, %d too small; covered %.4f, mean radius %.4g um\n", file,
              m.fields[0].whole, m.fields[0].cut, m.fields[0].too_small, m.shape_fraction.value,
              m.mean_radius.value * 1e6);
  return m;
}

/// By eye: 47 whole bubbles with a radius above 5 pixels, some six of them just so, and 10 at the frame.
/// Pixels below grey 50, between the black bubbles and all else, cover .200, and .203 with the glints that
/// they surround; the largest whole one has a radius of 363 um by its pixels.
TEST(Photographs, BubblesInGlass) {
  MicrographOptions reading;
  reading.pixel_m = 3.174e-6;
  reading.exclude = {{0, 878, 1024, 65}};  // the microscope's legend
  SegmentationOptions s;
  s.polarity = Polarity::dark;
  s.fill_holes = true;
  s.min_radius = 5;
  const Microstructure m = analyse("bubbles.jpg", reading, s);
  EXPECT_NEAR(m.fields[0].whole, 47, 6);
  EXPECT_EQ(m.fields[0].cut, 10);
  EXPECT_NEAR(m.shape_fraction.value, 0.2015, 0.006);
  double largest = 0;
  for (const Particle& p : m.particles)
    if (!p.cut) largest = std::max(largest, p.radius * 3.174);
  EXPECT_NEAR(largest, 363, 0.02 * 363);
  EXPECT_FALSE(m.round);
}

/// The notebooks that the picture comes from find 64 (by Otsu's threshold) and 63 (in ImageJ) connected
/// regions, which cover .342 and .329; 46 do not touch the frame, and the circles of their areas have a mean
/// radius of 10.45 pixels.
TEST(Photographs, Blobs) {
  MicrographOptions reading;
  reading.pixel_m = 1e-6;
  const Microstructure m = analyse("blobs.png", reading, {});
  EXPECT_TRUE(m.fields[0].bright);
  EXPECT_NEAR(m.fields[0].whole, 46, 2);
  EXPECT_NEAR(m.fields[0].whole + m.fields[0].cut + m.fields[0].too_small, 63.5, 2);
  EXPECT_NEAR(m.shape_fraction.value, 0.33, 0.02);
  EXPECT_NEAR(m.mean_radius.value * 1e6, 10.45, 0.04 * 10.45);
  EXPECT_NEAR(m.deviation.value * 1e6, 2.7, 0.3);
}

/// Five equal spheres, whose bright middles have a radius of 4.8 pixels where they are half as bright as they
/// get; the first one's position was published as (253.5, 24.5), in these coordinates. Dark rims would shift
/// and shrink them, if they counted as less than nothing.
TEST(Photographs, ColloidalSpheres) {
  MicrographOptions reading;
  reading.pixel_m = 0.15193e-6;
  SegmentationOptions s;
  s.fill_holes = true;
  const Microstructure m = analyse("colloids.png", reading, s);
  EXPECT_EQ(m.fields[0].whole, 5);
  EXPECT_EQ(m.fields[0].cut + m.fields[0].too_small, 0);
  EXPECT_TRUE(m.fields[0].bright);
  EXPECT_TRUE(m.round);
  ASSERT_EQ(m.particles.size(), 5u);
  const auto first = std::min_element(m.particles.begin(), m.particles.end(),
                                      [](const Particle& a, const Particle& b) { return a.y < b.y; });
  EXPECT_NEAR(first->x, 253.5, 1);
  EXPECT_NEAR(first->y, 24.5, 0.5);
  for (const Particle& p : m.particles) EXPECT_NEAR(p.radius, 4.8, 0.5);
  EXPECT_LT(m.deviation.value, 0.06 * m.mean_radius.value);
  EXPECT_NEAR(m.shape_fraction.value, 5 * M_PI * 4.8 * 4.8 / (450 * 400), 0.1 * 2e-3);
}

}  // namespace
}  // namespace aureole::test
