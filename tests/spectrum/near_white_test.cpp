// SPDX-License-Identifier: Apache-2.0
// Light colours have spectra that are nearly flat: slopes, bounds, colours after many reflections, continuity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"
#include "aureole/spectrum/upsampled_color.h"
#include "aureole/spectrum/upsampling_fit.h"

namespace aureole {
namespace {

SigmoidSpectrum from_table(const Rgb& c) {
  return upsample_srgb(static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]));
}
SigmoidSpectrum published(const Rgb& c) { return {fit_sigmoid(c), 1}; }

/// The colour of the spectrum `value(nm)` under D65, by the integrals of `tables.h` and the matrix of
/// `observer.h`, which the fit does not use.
template <class Value>
Rgb colour_of(const Value& value) {
  const TabulatedSpectrum d65 = *find_illuminant("D65");
  std::vector<double> nm, light;
  for (int l = 360; l <= 830; ++l) nm.push_back(l), light.push_back(value(float(l)) * d65.at(l));
  std::array<double, 3> xyz = cie_tristimulus({nm, light});
  for (double& v : xyz) v *= d65_whitepoint_normalization() / cie_y_integral();
  float rgb[3];
  xyz_to_srgb(xyz.data(), rgb);
  return {rgb[0], rgb[1], rgb[2]};
}

/// The largest change of a spectrum per nm where the eye sees, 400 to 700 nm.
double steepest(const SigmoidSpectrum& s) {
  double most = 0;
  for (int nm = 400; nm < 700; ++nm)
    most = std::max(most, double(std::abs(s.at(float(nm + 1)) - s.at(float(nm)))));
  return most;
}

/// Colours whose smallest component lies in a range; half of them on a bright face, with a component of 1.
std::vector<Rgb> colours(double from, double to, int count) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform;
  std::vector<Rgb> all;
  for (int i = 0; i < count; ++i) {
    const double least = from + (to - from) * uniform(generator);
    Rgb c;
    for (double& v : c) v = least + (1 - least) * uniform(generator);
    const auto k = std::size_t(generator() % 3);
    c[k] = least;
    if (i % 2) c[(k + 1 + generator() % 2) % 3] = 1;
    all.push_back(c);
  }
  return all;
}

// The table in docs/decisions/0140-near-white-colours.md is what this test prints.
TEST(NearWhite, SlopesShrinkTowardsWhite) {
  std::printf("largest slope of a spectrum, 400-700 nm [1/nm]\n");
  std::printf("smallest component   sigmoid   fit   table   fit / (1 - smallest)\n");
  for (const auto& [from, to] :
       {std::pair{0.99, 1.0}, {0.9, 0.99}, {0.8, 0.9}, {0.7, 0.8}, {0.5, 0.7}, {0.2, 0.5}, {0.0, 0.2}}) {
    double sigmoid = 0, fit = 0, table = 0, relative = 0;
    for (const Rgb& c : colours(from, to, 300)) {
      const double distance = 1 - std::min({c[0], c[1], c[2]});
      const double slope = steepest(fit_srgb(c)), of_table = steepest(from_table(c));
      sigmoid = std::max(sigmoid, steepest(published(c))), fit = std::max(fit, slope);
      table = std::max(table, of_table), relative = std::max(relative, slope / distance);
      // Darker colours keep the sigmoid, whose edges are up to 0.058 steep where a component is near 0.
      const double limit = std::min(0.031, 0.049 * distance + 2 * std::pow(distance, 4));
      if (from >= 0.5) {
        EXPECT_LT(slope, limit) << c[0] << " " << c[1] << " " << c[2];
        EXPECT_LT(of_table, limit) << c[0] << " " << c[1] << " " << c[2];
      }
    }
    std::printf("%.2f to %.2f         %.4f   %.4f   %.4f   %.3f\n", from, to, sigmoid, fit, table, relative);
  }
}

TEST(NearWhite, ColoursAreExactAndSpectraBounded) {
  double worst_fit = 0, worst_table = 0;
  for (const Rgb& c : colours(0.7, 1, 500)) {
    const double m = 1 - std::min({c[0], c[1], c[2]});
    const float least = float(1 - std::min(1.0, 4 * m / 3 + 0.6 * std::pow(m / 0.3, 4)));
    for (const SigmoidSpectrum& s : {fit_srgb(c), from_table(c)})
      for (float nm = 360; nm <= 830; nm += 5) {
        ASSERT_GE(s.at(nm), least - 1e-6f);
        ASSERT_LE(s.at(nm), 1.f);
      }
    const SigmoidSpectrum fit = fit_srgb(c), table = from_table(c);
    worst_fit = std::max(worst_fit, delta_e(c, colour_of([&](float nm) { return fit.at(nm); })));
    worst_table = std::max(worst_table, delta_e(c, colour_of([&](float nm) { return table.at(nm); })));
  }
  EXPECT_LT(worst_fit, 0.01);
  EXPECT_LT(worst_table, 0.1);
  RecordProperty("worst_fit", std::to_string(worst_fit));
  RecordProperty("worst_table", std::to_string(worst_table));
}

// A spectrum that is nearly flat has after n reflections the n-th power of its colour.
TEST(NearWhite, TwentyReflectionsHaveTheTwentiethPowerOfTheColour) {
  for (const Rgb& c : {Rgb{0.99, 0.999, 0.99}, Rgb{0.999, 0.999, 0.99}, Rgb{0.99, 0.999, 0.999},
                       Rgb{0.999, 0.99, 0.99}, Rgb{0.98, 0.99, 1}, Rgb{1, 0.99, 0.97}}) {
    for (const SigmoidSpectrum& s : {fit_srgb(c), from_table(c)}) {
      const Rgb is = colour_of([&](float nm) { return std::pow(double(s.at(nm)), 20); });
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(is[k], std::pow(c[k], 20), 0.02) << c[0] << " " << c[1] << " " << c[2] << ": " << k;
    }
  }
}

TEST(NearWhite, SpectraDoNotJump) {
  const auto difference = [](const SigmoidSpectrum& a, const SigmoidSpectrum& b) {
    float most = 0;
    for (float nm = 360; nm <= 830; nm += 5) most = std::max(most, std::abs(a.at(nm) - b.at(nm)));
    return most;
  };
  const double e = 1e-6;
  for (const Rgb& c : colours(0.75, 1, 500)) {
    // Smallest components where k becomes 1, and where lookups of the opposite colour end.
    for (const double border : {0.7, 0.5}) {
      Rgb below = c, above = c;
      const auto k = std::size_t(std::min_element(c.begin(), c.end()) - c.begin());
      below[k] = border - e, above[k] = border + e;
      EXPECT_LT(difference(fit_srgb(below), fit_srgb(above)), 1e-4f);
      EXPECT_LT(difference(from_table(below), from_table(above)), 1e-3f);
    }
    // Around white and greys, whose spectra are constants.
    const double v = c[0];
    const SigmoidSpectrum grey = from_table({v, v, v});
    EXPECT_LT(difference(grey, from_table({v, v - 1e-5, v})), 5e-3f * float(1 - v) + 1.5e-4f);
    const double tiny = 1e-4 * (1 - c[1]);
    EXPECT_LT(difference(from_table({1, 1, 1}), from_table({1 - tiny, 1, 1 - 0.5 * tiny})),
              float(1.5 * tiny) + 1e-6f);
  }
}

TEST(NearWhite, UnboundedColoursKeepThePublishedModel) {
  const SigmoidSpectrum s = fit_unbounded({4, 3.6, 3.8});
  const SigmoidPolynomial half = fit_sigmoid({0.5, 0.45, 0.475});
  const SigmoidSpectrum table = upsample_unbounded(4, 3.6f, 3.8f);
  for (float nm = 360; nm <= 830; nm += 10) {
    EXPECT_FLOAT_EQ(s.at(nm), 8 * half.at(nm));
    EXPECT_NEAR(table.at(nm), 8 * half.at(nm), 0.05);
  }
}

TEST(NearWhite, RangeOfManyColoursIsThatOfEach) {
  for (int first = 0; first < 300; first += 20) {
    const auto all = colours(0, 1, 300);
    ColorRange range;
    float low = 1, high = 0;
    for (int i = first; i < first + 20; ++i) {
      const Rgb& c = all[std::size_t(i)];
      const UpsampledColor packed = UpsampledColor::of_rgb(float(c[0]), float(c[1]), float(c[2]));
      range.extend(packed);
      low = std::min(low, packed.range().first), high = std::max(high, packed.range().second);
    }
    EXPECT_NEAR(range.values().first, low, 1e-6f);
    EXPECT_NEAR(range.values().second, high, 1e-6f);
  }
}

TEST(NearWhite, CompactColoursAreTheirSpectra) {
  for (const Rgb& c : colours(0, 1, 300)) {
    const SigmoidSpectrum s = from_table(c);
    const UpsampledColor packed = UpsampledColor::of_rgb(float(c[0]), float(c[1]), float(c[2]));
    const auto [low, high] = packed.range();
    const auto [low_500, high_500] = packed.range(500, 520);
    for (float nm = 360; nm <= 830; nm += 2) {
      const float v = packed.eval(Spectrum(nm))[3];
      ASSERT_NEAR(v, s.at(nm), 1e-5f);
      ASSERT_LE(v, high + 1e-5f);
      ASSERT_GE(v, low - 1e-5f);
      if (nm < 500 || nm > 520) continue;
      ASSERT_LE(v, high_500 + 1e-5f);
      ASSERT_GE(v, low_500 - 1e-5f);
    }
  }
}

}  // namespace
}  // namespace aureole
