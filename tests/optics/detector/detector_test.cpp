// SPDX-License-Identifier: Apache-2.0
// The noise of an image sensor against the equations of EMVA 1288, and transfer functions against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "aureole/optics/detector/photodetector.h"

namespace aureole::optics {
namespace {

struct Statistics {
  double mean = 0, variance = 0;
};
template <class Draw>
Statistics statistics_of(int count, Draw&& draw) {
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double x = draw(std::uint64_t(i));
    sum += x, squares += x * x;
  }
  const double mean = sum / count;
  return {mean, (squares - sum * mean) / (count - 1)};
}

TEST(Detector, PoissonNumbersHaveTheirMomentsAndProbabilities) {
  constexpr int kCount = 400000;
  for (const double mean : {0.3, 4.0, 9.9, 10.1, 31.0, 250.0, 40000.0}) {
    DetectorRandom random(std::uint64_t(mean * 1000));
    std::vector<int> counts(200);
    const Statistics s = statistics_of(kCount, [&](std::uint64_t) {
      const double n = random.poisson(mean);
      EXPECT_EQ(n, std::floor(n));
      if (n < 200) ++counts[std::size_t(n)];
      return n;
    });
    EXPECT_NEAR(s.mean, mean, 4.5 * std::sqrt(mean / kCount)) << mean;
    // The variance of a sample variance is (mu + 2 mu^2)/n.
    EXPECT_NEAR(s.variance, mean, 4.5 * std::sqrt((mean + 2 * mean * mean) / kCount)) << mean;
    if (mean > 100) continue;
    double chi = 0;
    int cells = 0;
    for (int n = 0; n < 200; ++n) {
      const double expected = kCount * std::exp(-mean + n * std::log(mean) - std::lgamma(n + 1.0));
      if (expected < 20) continue;
      chi += std::pow(counts[std::size_t(n)] - expected, 2) / expected, ++cells;
    }
    // 4.5 standard deviations of chi-square, which has the variance 2 per cell.
    EXPECT_LT(chi, cells + 4.5 * std::sqrt(2.0 * cells)) << mean;
  }
}

TEST(Detector, VarianceOverFramesFollowsThePhotonTransferCurve) {
  // K = 0.5 and 5 electrons of dark noise: 0.25 (25 + n) + 1/12 is 31.333 at 100 electrons and 256.333 at 1000.
  const DetectorModel d{.full_well = 1e5, .read_noise = 5, .gain = 0.5, .black_level = 200, .bits = 12};
  EXPECT_NEAR(d.temporal_variance(100), 31.333, 5e-4);
  EXPECT_NEAR(d.temporal_variance(1000), 256.333, 5e-4);
  constexpr int kFrames = 400000;
  for (const auto& [electrons, variance] : {std::pair(100.0, 31.333), std::pair(1000.0, 256.333)}) {
    const Statistics s = statistics_of(
        kFrames, [&](std::uint64_t frame) { return double(read_pixel(d, electrons, 0.01, 7, 1, frame)); });
    EXPECT_NEAR(s.mean, 200 + 0.5 * electrons, 4.5 * std::sqrt(variance / kFrames));
    EXPECT_NEAR(s.variance, variance, 4.5 * variance * std::sqrt(2.0 / kFrames));
  }
}

TEST(Detector, PatternsOfPixelsAreFixed) {
  const DetectorModel d{.full_well = 1e6,
                        .read_noise = 0,
                        .dark_nonuniformity = 20,
                        .photo_nonuniformity = 0.02,
                        .gain = 1,
                        .black_level = 1000,
                        .bits = 16};
  // Without light and read noise frames are equal, and the offsets of pixels have the standard deviation of DSNU.
  for (std::uint64_t pixel : {1u, 2u, 3u})
    EXPECT_EQ(read_pixel(d, 0, 1, pixel, 5, 1), read_pixel(d, 0, 1, pixel, 5, 2));
  constexpr int kPixels = 200000;
  const Statistics dark =
      statistics_of(kPixels, [&](std::uint64_t pixel) { return double(read_pixel(d, 0, 1, pixel, 5, 1)); });
  EXPECT_NEAR(dark.mean, 1000, 0.3);
  EXPECT_NEAR(dark.variance, 400 + 1 / 12.0, 400 * 4.5 * std::sqrt(2.0 / kPixels));
  // With light the response adds its own, and light its noise: 20^2 + 30000 + (0.02 x 30000)^2.
  const Statistics lit = statistics_of(
      kPixels, [&](std::uint64_t pixel) { return double(read_pixel(d, 30000, 1, pixel, 5, 1)); });
  const double expected = 400 + 30000 + 360000;
  EXPECT_NEAR(lit.mean, 31000, 4.5 * std::sqrt(expected / kPixels));
  EXPECT_NEAR(lit.variance, expected, expected * 4.5 * std::sqrt(2.0 / kPixels));
  // Another sensor has another pattern.
  std::set<int> values;
  for (std::uint64_t sensor = 0; sensor < 50; ++sensor) values.insert(read_pixel(d, 0, 1, 9, sensor, 1));
  EXPECT_GT(values.size(), 20u);
}

TEST(Detector, DarkCurrentAddsElectronsAndTheirNoise) {
  const DetectorModel d{
      .full_well = 1e5, .read_noise = 0, .dark_current = 50, .gain = 1, .black_level = 100, .bits = 16};
  const Statistics s =
      statistics_of(200000, [&](std::uint64_t frame) { return double(read_pixel(d, 0, 4, 1, 1, frame)); });
  EXPECT_NEAR(s.mean, 300, 0.15);
  EXPECT_NEAR(s.variance, 200 + 1 / 12.0, 3);
}

TEST(Detector, SaturatesAtTheWellAndAtTheConverter) {
  DetectorModel d{.full_well = 1000, .read_noise = 0, .gain = 1, .black_level = 10, .bits = 12};
  EXPECT_EQ(read_pixel(d, 1e6, 1, 1, 1, 1), 1010);
  EXPECT_DOUBLE_EQ(d.saturation(), 1000);
  d.full_well = 1e6;
  EXPECT_EQ(read_pixel(d, 1e6, 1, 1, 1, 1), 4095);
  EXPECT_DOUBLE_EQ(d.saturation(), 4085);
  d.read_noise = 1000;
  int black = 0;
  for (std::uint64_t frame = 0; frame < 100; ++frame) black += read_pixel(d, 0, 1, 1, 1, frame) == 0;
  EXPECT_GT(black, 20);  // noise below zero is cut
}

TEST(Detector, ImpossibleSensors) {
  const auto wrong = [](auto change) {
    DetectorModel d;
    d.check();
    change(d);
    EXPECT_THROW(d.check(), std::domain_error);
  };
  wrong([](DetectorModel& d) { d.full_well = 0; });
  wrong([](DetectorModel& d) { d.read_noise = -1; });
  wrong([](DetectorModel& d) { d.dark_current = NAN; });
  wrong([](DetectorModel& d) { d.dark_nonuniformity = -1; });
  wrong([](DetectorModel& d) { d.photo_nonuniformity = 2; });
  wrong([](DetectorModel& d) { d.gain = 0; });
  wrong([](DetectorModel& d) { d.bits = 17; });
  wrong([](DetectorModel& d) { d.black_level = 5000; });
  EXPECT_THROW(ColorMosaic::named("rgbg"), std::domain_error);
}

TEST(Detector, Mosaics) {
  const ColorMosaic x = ColorMosaic::named("xtrans");
  // 20 green, 8 red and 8 blue filters; every row and column has all colours.
  int count[3] = {};
  for (int y = 0; y < 6; ++y) {
    std::set<int> row, column;
    for (int k = 0; k < 6; ++k) ++count[x.at(k, y)], row.insert(x.at(k, y)), column.insert(x.at(y, k));
    EXPECT_EQ(row.size(), 3u);
    EXPECT_EQ(column.size(), 3u);
  }
  EXPECT_EQ(count[0], 8);
  EXPECT_EQ(count[1], 20);
  EXPECT_EQ(count[2], 8);
  const ColorMosaic b = ColorMosaic::named("grbg");
  EXPECT_EQ(b.at(0, 0), 1);
  EXPECT_EQ(b.at(1, 0), 0);
  EXPECT_EQ(b.at(0, 1), 2);
  EXPECT_EQ(b.at(7, 9), 1);
}

TEST(Detector, ApertureLaws) {
  EXPECT_NEAR(aperture_solid_angle(2, ApertureLaw::sine), M_PI / 16, 1e-12);
  // pi/(4 N^2 + 1).
  EXPECT_NEAR(aperture_solid_angle(2, ApertureLaw::thin), M_PI / 17, 1e-12);
  EXPECT_THROW(aperture_solid_angle(0.4, ApertureLaw::sine), std::domain_error);
  EXPECT_THROW(aperture_solid_angle(0, ApertureLaw::thin), std::domain_error);
}

TEST(Detector, ModulationTransferOfAPixelAtNyquist) {
  EXPECT_NEAR(pixel_mtf(0.5), 0.63662, 5e-6);
  EXPECT_EQ(pixel_mtf(0), 1);
  EXPECT_NEAR(pixel_mtf(1), 0, 1e-12);
}

TEST(Detector, ModulationTransferOfDiffractionAtHalfItsCutoff) {
  EXPECT_NEAR(diffraction_mtf(0.5, 1), 0.39100, 5e-6);
  EXPECT_NEAR(diffraction_mtf(0, 1), 1, 1e-12);
  EXPECT_EQ(diffraction_mtf(1, 1), 0);
  // The autocorrelation of a disc, counted on a grid.
  constexpr int kCells = 1500;
  int both = 0, one = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const double x = 2 * (i + 0.5) / kCells - 1, y = 2 * (j + 0.5) / kCells - 1;
      if (x * x + y * y > 1) continue;
      ++one;
      both += (x - 0.6) * (x - 0.6) + y * y <= 1;
    }
  EXPECT_NEAR(diffraction_mtf(0.3, 1), double(both) / one, 2e-3);
}

}  // namespace
}  // namespace aureole::optics
