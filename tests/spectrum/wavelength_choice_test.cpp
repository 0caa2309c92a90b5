// SPDX-License-Identifier: Apache-2.0
// The choice of p_lambda: how much the channels of a picture differ between sets of wavelengths, computed
// here by brute force over offsets, for lights from smooth to a single line.
#include "aureole/spectrum/wavelength_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/spectrum/observer.h"

namespace aureole {
namespace {

const SpectralGrid kGrid;

std::vector<SampledSpectrum> rgb_channels() {
  const auto xyz = observer_xyz(kGrid);
  std::vector<std::vector<float>> nodes(3, std::vector<float>(size_t(kGrid.cells) + 1));
  for (size_t i = 0; i < nodes[0].size(); ++i) {
    const double at[3] = {xyz[0].nodes()[i], xyz[1].nodes()[i], xyz[2].nodes()[i]};
    float rgb[3];
    xyz_to_srgb(at, rgb);
    for (size_t c = 0; c < 3; ++c) nodes[c][i] = rgb[c];
  }
  return {{kGrid, nodes[0]}, {kGrid, nodes[1]}, {kGrid, nodes[2]}};
}

SampledSpectrum response() {
  const auto xyz = observer_xyz(kGrid);
  std::vector<float> nodes(size_t(kGrid.cells) + 1);
  for (const auto& s : xyz)
    for (size_t i = 0; i < nodes.size(); ++i) nodes[i] += s.nodes()[i];
  return {kGrid, nodes};
}

SampledSpectrum lines(std::initializer_list<std::pair<double, double>> centers_and_widths) {
  return SampledSpectrum::from_function(kGrid, [&](double nm) {
    double s = 0;
    for (const auto& [center, width] : centers_and_widths)
      s += std::exp(-0.5 * std::pow((nm - center) / width, 2)) / width;
    return s;
  });
}

/// Half response, half response times light: the best density for single wavelengths.
WavelengthDistribution sharp(const SampledSpectrum& light) {
  const SampledSpectrum densities[2] = {response(), product(response(), light)};
  const float weights[2] = {0.5f, 0.5f};
  return {kGrid, densities, weights};
}

/// Relative variance between sets by other sums: one look-up after the other, in double.
double brute_force(const WavelengthDistribution& d, const std::vector<SampledSpectrum>& channels,
                   const SampledSpectrum& light) {
  constexpr int kOffsets = 1024;
  const auto at = [](const SampledSpectrum& s, double nm) {
    const double x = (nm - kGrid.min_nm) / kGrid.step();
    const int i = std::clamp(int(x), 0, kGrid.cells - 1);
    return std::lerp(double(s.nodes()[size_t(i)]), double(s.nodes()[size_t(i) + 1]), x - i);
  };
  double variance = 0, squared = 0;
  for (const SampledSpectrum& c : channels) {
    double sum1 = 0, sum2 = 0;
    for (int k = 0; k < kOffsets; ++k) {
      const Wavelengths w = d.sample(float((k + 0.5) / kOffsets / kWavelengths));
      double x = 0;
      for (int j = 0; j < kWavelengths; ++j)
        x += at(c, w.nm[j]) * at(light, w.nm[j]) / (kWavelengths * double(d.pdf(w.nm[j])));
      sum1 += x / kOffsets, sum2 += x * x / kOffsets;
    }
    variance += sum2 - sum1 * sum1, squared += sum1 * sum1;
  }
  return variance / squared;
}

WavelengthDistribution chosen(std::vector<SampledSpectrum> lights) {
  return choose_wavelengths(response(), rgb_channels(), lights);
}

TEST(WavelengthChoice, VarianceIsThatOfBruteForce) {
  for (const SampledSpectrum& light : {d65_spectrum(kGrid, 1), lines({{546, 3}, {611, 3}, {436, 3}})}) {
    const double expected = brute_force(sharp(light), rgb_channels(), light);
    EXPECT_NEAR(variance_between_sets(sharp(light), rgb_channels(), light), expected, 0.05 * expected);
  }
}

TEST(WavelengthChoice, SmoothLightsGetAWideDensity) {
  const SampledSpectrum warm = SampledSpectrum::from_function(kGrid, [](double nm) { return nm - 300; });
  for (const SampledSpectrum& light : {d65_spectrum(kGrid, 1), SampledSpectrum::constant(kGrid, 2), warm}) {
    const double before = brute_force(sharp(light), rgb_channels(), light);
    const double after = brute_force(chosen({light}), rgb_channels(), light);
    RecordProperty("before", std::to_string(before));
    EXPECT_LT(after, kWavelengths == 8 ? before / 10 : before);
  }
}

TEST(WavelengthChoice, LinesAreFound) {
  for (const SampledSpectrum& light : {lines({{589.3, 0.8}}), lines({{436, 1}, {546, 1}, {578, 1}})})
    EXPECT_LE(brute_force(chosen({light}), rgb_channels(), light),
              1.05 * brute_force(sharp(light), rgb_channels(), light));
}

TEST(WavelengthChoice, AWeakLampCountsBesideAStrongOne) {
  SampledSpectrum sodium = lines({{589.3, 0.8}});
  sodium.scale(1e-3f);
  const SampledSpectrum day = d65_spectrum(kGrid, 1);
  const WavelengthDistribution both = chosen({day, sodium});
  std::vector<float> sum(sodium.nodes().begin(), sodium.nodes().end());
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += day.nodes()[i];
  const WavelengthDistribution together = chosen({{kGrid, sum}});
  EXPECT_LT(brute_force(both, rgb_channels(), sodium), 0.1 * brute_force(together, rgb_channels(), sodium));
  EXPECT_LT(brute_force(both, rgb_channels(), day), brute_force(sharp(day), rgb_channels(), day));
}

TEST(WavelengthChoice, ALineAmongLampsGetsAWavelengthOfEachSet) {
  // Of six lamps an equal share is half of what the sodium line needs.
  std::vector<SampledSpectrum> lamps = {d65_spectrum(kGrid, 1), lines({{589.3, 0.8}})};
  for (const double nm : {468., 511., 560., 634.}) lamps.push_back(lines({{nm, 12}}));
  for (std::size_t i = 0; i < lamps.size(); ++i) lamps[i].scale(i > 0 ? 1e-3f : 1.f);
  const WavelengthDistribution d = chosen(lamps);
  if (kWavelengths == 8) {
    for (const SampledSpectrum& lamp : lamps) EXPECT_LT(brute_force(d, rgb_channels(), lamp), 0.2);
  }
}

TEST(WavelengthChoice, EachOfManyLampsIsFound) {
  std::vector<SampledSpectrum> lamps;
  for (int k = 0; k < 24; ++k) lamps.push_back(lines({{430. + 10 * k, 1}}));
  const WavelengthDistribution d = chosen(lamps);
  // Were nothing but lines seen, a set would have that of one lamp with probability N / 24.
  for (const SampledSpectrum& lamp : lamps)
    EXPECT_LT(brute_force(d, rgb_channels(), lamp), 3 * (24. / kWavelengths));
}

TEST(WavelengthChoice, LampsThatAreAlikeCountOnce) {
  SampledSpectrum sodium = lines({{589.3, 0.8}}), day = d65_spectrum(kGrid, 1), faint = day;
  sodium.scale(1e-2f), faint.scale(0.5f);
  const WavelengthDistribution once = chosen({day, sodium}), often = chosen({day, sodium, faint, day, faint});
  for (const float nm : {400.f, 500.f, 589.3f, 650.f})
    EXPECT_NEAR(often.pdf(nm), once.pdf(nm), 0.05f * once.pdf(nm)) << nm;
}

TEST(WavelengthChoice, EveryScaleAndNoLight) {
  SampledSpectrum faint = d65_spectrum(kGrid, 1), strong = faint;
  faint.scale(1e-35f), strong.scale(1e25f);
  const WavelengthDistribution expected = chosen({d65_spectrum(kGrid, 1)});
  for (const float nm : {400.f, 500.f, 600.f, 700.f}) {
    EXPECT_NEAR(chosen({faint}).pdf(nm), expected.pdf(nm), 1e-3f * expected.pdf(nm));
    EXPECT_NEAR(chosen({strong}).pdf(nm), expected.pdf(nm), 1e-3f * expected.pdf(nm));
    EXPECT_GT(chosen({}).pdf(nm), 0);
    EXPECT_GT(chosen({SampledSpectrum::constant(kGrid, 0)}).pdf(nm), 0);
  }
  // Light that the film does not see has no part in the choice.
  const SampledSpectrum unseen = lines({{829.9, 0.01}});
  EXPECT_GT(chosen({unseen, faint}).pdf(550), 0);
}

TEST(WavelengthChoice, NarrowAndWideRanges) {
  // A range of 1e-4 nm took minutes: 80 nm of smoothing are 10^8 of its cells.
  for (const auto& [min_nm, max_nm] :
       {std::pair{500., 500.0001}, std::pair{589., 590.}, std::pair{1., 1e9}}) {
    const SpectralGrid grid = SpectralGrid::over(min_nm, max_nm);
    const SampledSpectrum flat = SampledSpectrum::constant(grid, 1), lights[] = {flat};
    const SampledSpectrum channels[] = {flat};
    const float middle = float((min_nm + max_nm) / 2);
    EXPECT_NEAR(choose_wavelengths(flat, channels, lights).pdf(middle) * (max_nm - min_nm), 1, 0.05);
  }
}

TEST(WavelengthChoice, ManyChannels) {
  std::vector<SampledSpectrum> bins;
  for (int b = 0; b < 47; ++b)
    bins.push_back(SampledSpectrum::from_function(
        kGrid, [&](double nm) { return nm >= 360 + 10 * b && nm < 370 + 10 * b ? 0.1 : 0; }));
  const SampledSpectrum flat = SampledSpectrum::constant(kGrid, 0.1f), lights[] = {d65_spectrum(kGrid, 1)};
  const WavelengthDistribution d = choose_wavelengths(flat, bins, lights);
  for (float nm = 365; nm < 830; nm += 10) EXPECT_GT(d.pdf(nm), 0.3f / 470) << nm;
}

}  // namespace
}  // namespace aureole
