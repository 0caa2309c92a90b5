// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/spectroradiometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace aureole::optics {
namespace {

/// The position of a wavelength on the array, by bisection.
double pixel_of(const ArraySpectrograph& s, double nm) {
  double low = 0, high = s.pixels - 1;
  for (int k = 0; k < 80; ++k) (s.nm_at(0.5 * (low + high)) < nm ? low : high) = 0.5 * (low + high);
  return low;
}

TEST(Spectroradiometer, EvenLightReadsItsDensityTimesTheResponsivity) {
  ArraySpectrograph s;
  s.scattered = s.halo = 0;
  const std::vector<double> signal = array_signal(s, [](double) { return 2.0; });
  for (const int i : {40, 256, 470})
    EXPECT_NEAR(signal[std::size_t(i)], 2 * s.responsivity(s.nm_at(i)), 2e-3);
}

TEST(Spectroradiometer, LinesOfMercuryCalibrateTheScale) {
  ArraySpectrograph s;
  s.slit_nm = 5;
  const double lines[] = {404.656, 435.833, 546.074, 696.543, 763.511, 811.531};
  std::vector<double> signal(std::size_t(s.pixels));
  for (const double nm : lines) {
    const std::vector<double> line = line_signal(s, nm);
    for (std::size_t i = 0; i < signal.size(); ++i) signal[i] += line[i];
  }
  const WavelengthScale scale = calibrate_wavelengths(signal, lines, s.first_nm, s.last_nm, 12);
  EXPECT_LT(scale.residual_nm, 0.06);
  // The linear scale is 4 nm off in the middle.
  for (const double nm : {450.0, 550.0, 650.0, 750.0}) EXPECT_NEAR(scale.nm_at(pixel_of(s, nm)), nm, 0.15);
  const double few[] = {435.8, 546.1};
  EXPECT_THROW(calibrate_wavelengths(signal, few, s.first_nm, s.last_nm, 12), std::domain_error);
}

TEST(Spectroradiometer, StrayLightMatrixRemovesLightFarFromALine) {
  const ArraySpectrograph s;
  const StrayLightMatrix matrix(s);
  // A laser between pixels, whose slit function no column has.
  const std::vector<double> raw = line_signal(s, 0.5 * (s.nm_at(300) + s.nm_at(301))),
                            clean = matrix.corrected(raw);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < raw.size(); ++i)
    if (std::abs(s.nm_at(double(i)) - s.nm_at(300.5)) > 2 * s.slit_nm)
      before += std::abs(raw[i]), after += std::abs(clean[i]);
  EXPECT_GT(before, 0.003 * std::accumulate(raw.begin(), raw.end(), 0.0));
  EXPECT_LT(after, 0.02 * before);
  // The light within the slit function stays.
  EXPECT_NEAR(clean[300], raw[300], 0.01 * raw[300]);
}

TEST(Spectroradiometer, DeconvolutionTellsTwoLinesApart) {
  ArraySpectrograph s;
  s.slit_nm = 8, s.scattered = s.halo = 0;
  const double middle = s.nm_at(256);
  std::vector<double> two = line_signal(s, middle - 4), other = line_signal(s, middle + 4);
  for (std::size_t i = 0; i < two.size(); ++i) two[i] += other[i];
  const auto dip = [&](const std::vector<double>& v) {
    const double peak = v[std::size_t(std::lround(pixel_of(s, middle - 4)))];
    return v[256] / peak;
  };
  const std::vector<double> sharp = without_slit(s, two, 200);
  EXPECT_GT(dip(two), 0.9);
  EXPECT_LT(dip(sharp), 0.3);
  // An even spectrum stays even.
  for (const double v : without_slit(s, std::vector<double>(512, 3.0), 50)) EXPECT_NEAR(v, 3, 1e-9);
}

TEST(Spectroradiometer, NoiseHasTheVarianceOfCountedElectrons) {
  ArraySpectrograph s;
  s.electrons = 1e4, s.read_noise = 20;
  const std::vector<double> clean(std::size_t(s.pixels), 1.0);
  double squares = 0;
  int n = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const double v : with_array_noise(s, clean, seed)) squares += (v - 1) * (v - 1), ++n;
  EXPECT_NEAR(squares / n, (1e4 + 400) / 1e8, 0.05 * 1.04e-4);
  EXPECT_EQ(with_array_noise(s, clean, 3), with_array_noise(s, clean, 3));
}

TEST(Spectroradiometer, BadNumbersAreErrors) {
  ArraySpectrograph s;
  s.slit_nm = 0;
  EXPECT_THROW(line_signal(s, 550), std::domain_error);
  s = {};
  s.pixels = 3;
  EXPECT_THROW(array_signal(s, [](double) { return 1.0; }), std::domain_error);
  s = {};
  s.halo = 0.6;
  EXPECT_THROW(StrayLightMatrix{s}, std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
