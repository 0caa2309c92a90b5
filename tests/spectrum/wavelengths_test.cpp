// SPDX-License-Identifier: Apache-2.0
// Spectra on a grid, the density of wavelengths and spectral MIS, against scalar interpolation, sums by hand
// and a toy problem with a known answer.
#include "aureole/spectrum/wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "aureole/core/error.h"
#include "aureole/spectrum/path_density.h"
#include "aureole/transport/connection.h"

namespace aureole {
namespace {

/// The area under a polyline between a and b, piece by piece.
double polyline_integral(const std::vector<double>& x, const std::vector<double>& y, double a, double b) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double lo = std::max(a, x[i]), hi = std::min(b, x[i + 1]);
    if (hi <= lo) continue;
    const auto at = [&](double t) { return std::lerp(y[i], y[i + 1], (t - x[i]) / (x[i + 1] - x[i])); };
    sum += (hi - lo) * (at(lo) + at(hi)) / 2;
  }
  return sum;
}

double scalar_lookup(const SampledSpectrum& s, double nm) {
  const double x = (nm - s.grid().min_nm) / s.grid().step();
  const int i = std::clamp(int(x), 0, s.grid().cells - 1);
  return std::lerp(double(s.nodes()[std::size_t(i)]), double(s.nodes()[std::size_t(i) + 1]), x - i);
}

SampledSpectrum tabulate(const SpectralGrid& grid, const std::vector<double>& nm,
                         const std::vector<double>& values) {
  return SampledSpectrum::from_points(grid, nm, values);
}

TEST(SpectralGrid, CellsFollowTheWidth) {
  EXPECT_EQ(SpectralGrid::over(360, 830).cells, 470);
  EXPECT_EQ(SpectralGrid::over(360, 830), SpectralGrid{});
  EXPECT_EQ(SpectralGrid::over(589, 590).cells, 64);
  EXPECT_EQ(SpectralGrid::over(1e7, 1e9).cells, 2000);
  EXPECT_DOUBLE_EQ(SpectralGrid::over(1e7, 1e9).node(2000), 1e9);
  EXPECT_THROW(SpectralGrid::over(0, 500), Error);
  EXPECT_THROW(SpectralGrid::over(500, 500), Error);
  EXPECT_THROW(SpectralGrid::over(500, INFINITY), Error);
  EXPECT_THROW(SpectralGrid::over(NAN, 500), Error);
}

TEST(SampledSpectrum, LinearPiecesAreUnchanged) {
  const SpectralGrid grid = SpectralGrid::over(400, 700);
  // The two ends are means over half a hat: a third of a cell inside.
  const auto place = [&](int i) {
    return grid.node(i) + (i == 0 ? grid.step() / 3 : i == grid.cells ? -grid.step() / 3 : 0);
  };
  const SampledSpectrum s = tabulate(grid, {300, 900}, {1, 13});
  for (int i = 0; i <= grid.cells; ++i)
    EXPECT_NEAR(s.nodes()[std::size_t(i)], 1 + (place(i) - 300) * 0.02, 1e-5) << i;
  // Away from the corner of a polyline, too.
  const SampledSpectrum t = tabulate(grid, {400, 550.3, 700}, {2, 5, 0});
  for (int i = 0; i <= grid.cells; ++i) {
    const double nm = place(i);
    if (std::abs(nm - 550.3) <= grid.step()) continue;
    EXPECT_NEAR(t.nodes()[std::size_t(i)], nm < 550.3 ? 2 + 3 * (nm - 400) / 150.3 : 5 * (700 - nm) / 149.7,
                1e-5);
  }
}

TEST(SampledSpectrum, IntegralIsKept) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const auto& [low, high] : {std::pair{360.0, 830.0}, {589.0, 590.0}, {3000.0, 12000.0}, {1e7, 1e9}}) {
    const SpectralGrid grid = SpectralGrid::over(low, high);
    const double width = high - low;
    for (int test = 0; test < 200; ++test) {
      // Points from far finer than a cell to far coarser, some outside the grid.
      std::vector<double> nm, values;
      double x = low - 0.2 * width * uniform(random) + 0.3 * width * uniform(random);
      const int count = 2 + int(uniform(random) * 12);
      for (int k = 0; k < count; ++k) {
        nm.push_back(x);
        values.push_back(uniform(random) < 0.2 ? 0 : std::exp(6 * uniform(random)));
        x += grid.step() * std::exp(std::log(0.01) + uniform(random) * std::log(1e4));
      }
      const double expected = polyline_integral(nm, values, low, high);
      EXPECT_NEAR(tabulate(grid, nm, values).integral(), expected, 1e-5 * expected + 1e-12 * width)
          << low << " test " << test;
    }
  }
}

TEST(SampledSpectrum, NarrowLinesKeepPowerAndPlace) {
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  for (const double center : {589.3, 400.0, 400.5, 829.99, 360.004}) {
    const double h = 1e-3;
    const SampledSpectrum s = tabulate(grid, {center - h, center, center + h}, {0, 1000, 0});
    EXPECT_NEAR(s.integral(), 1, 1e-5) << center;
    double mean = 0;
    for (int i = 0; i <= grid.cells; ++i) {
      const double weight = i == 0 || i == grid.cells ? 0.5 : 1;
      mean += weight * grid.step() * s.nodes()[std::size_t(i)] * grid.node(i);
    }
    EXPECT_NEAR(mean, center, 1e-3);
    for (int i = 0; i <= grid.cells; ++i)
      if (std::abs(grid.node(i) - center) > 1.01) {
        EXPECT_EQ(s.nodes()[std::size_t(i)], 0.f);
      }
  }
}

TEST(SampledSpectrum, StepsKeepTheirIntegral) {
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const SampledSpectrum s = tabulate(grid, {360, 500.25, 500.25, 830}, {1, 1, 3, 3});
  EXPECT_NEAR(s.integral(), 140.25 + 3 * 329.75, 1e-2);
  EXPECT_NEAR(s.nodes()[139], 1, 1e-6);
  EXPECT_NEAR(s.nodes()[142], 3, 1e-6);
  // Between, the mean of the step weighted by the node's hat: 1 + 2 * integral of the hat right of 500.25.
  EXPECT_NEAR(s.nodes()[140], 1 + 2 * 0.75 * 0.75 / 2, 1e-6);
}

TEST(SampledSpectrum, OutsideTheGridIsNothing) {
  const SpectralGrid grid = SpectralGrid::over(500, 600);
  EXPECT_EQ(tabulate(grid, {300, 499.5}, {5, 5}).maximum(), 0);
  EXPECT_EQ(tabulate(grid, {600.5, 900}, {5, 5}).maximum(), 0);
  EXPECT_EQ(tabulate(grid, {550}, {5}).maximum(), 0);
  EXPECT_EQ(tabulate(grid, {}, {}).maximum(), 0);
  const SampledSpectrum s = tabulate(grid, {520, 540}, {2, 2});
  EXPECT_EQ(s.nodes()[10], 0);
  EXPECT_EQ(s.nodes()[45], 0);
  EXPECT_EQ(s.nodes()[30], 2);
  EXPECT_NEAR(s.integral(), 40, 1e-5);
}

TEST(SampledSpectrum, EvalIsLinearInterpolation) {
  std::mt19937 random(5);
  for (const auto& [low, high] : {std::pair{360.0, 830.0}, {589.0, 590.0}, {1e7, 1e9}}) {
    const SpectralGrid grid = SpectralGrid::over(low, high);
    std::uniform_real_distribution<float> place{float(low), float(high)};
    std::vector<float> nodes;
    for (int i = 0; i <= grid.cells; ++i) nodes.push_back(place(random) / float(high));
    const SampledSpectrum s(grid, nodes);
    for (int test = 0; test < 1000; ++test) {
      const Spectrum nm = make_spectrum([&](int i) {
        return test == 0   ? float(i % 2 ? high : low)
               : test < 50 ? float(grid.node(7 * test + i % 7))
                           : place(random);
      });
      const Wavelengths w = Wavelengths::at(grid, min(nm, float(high)));
      const Spectrum value = s.eval(w);
      // Rounding of the wavelength moves along the steepest piece.
      const double slack = 2e-6 + 1e-7 * (test >= 50 ? high / grid.step() : 0) + 2e-6 * grid.cells;
      for (int i = 0; i < kWavelengths; ++i)
        ASSERT_NEAR(value[i], scalar_lookup(s, double(w.nm[i])), test ? slack : 1e-6) << nm[i];
    }
  }
}

TEST(SampledSpectrum, Moments) {
  const SpectralGrid grid = SpectralGrid::over(400, 500);
  const SampledSpectrum s =
      SampledSpectrum::from_function(grid, [](double nm) { return (nm - 400) * (nm - 400); });
  EXPECT_NEAR(s.integral(), 1e6 / 3, 20);  // the trapezoidal rule is 1/6 per cell too high
  EXPECT_NEAR(s.average(), 1e4 / 3, 0.2);
  EXPECT_EQ(s.maximum(), 1e4f);
  EXPECT_EQ(s.minimum(), 0.f);
  EXPECT_THROW(SampledSpectrum(grid, std::vector<float>(100)), std::logic_error);
}

/// Ranges with spectra of all kinds: smooth, steps, a line.
struct Range {
  double low, high;
};
class Distribution : public ::testing::TestWithParam<Range> {
protected:
  Distribution() : grid(SpectralGrid::over(GetParam().low, GetParam().high)) {
    const double width = grid.max_nm - grid.min_nm;
    const auto at = [&](double t) { return grid.min_nm + t * width; };
    bump = SampledSpectrum::from_function(grid, [&](double nm) {
      const double t = (nm - grid.min_nm) / width;
      return 17 * std::exp(-50 * (t - 0.4) * (t - 0.4));
    });
    const double c = at(0.613), h = 0.01 * grid.step();
    line = SampledSpectrum::from_points(grid, std::vector<double>{c - h, c, c + h},
                                        std::vector<double>{0, 1, 0});
  }
  /// The density that is asked for, per cell.
  std::vector<double> mixture(double a, double b) const {
    std::vector<double> mass;
    const double total = a + b;
    for (int c = 0; c < grid.cells; ++c) {
      const auto part = [&](const SampledSpectrum& s) {
        double sum = 0;
        for (int i = 0; i < grid.cells; ++i)
          sum += (s.nodes()[std::size_t(i)] + s.nodes()[std::size_t(i) + 1]) / 2;
        return (s.nodes()[std::size_t(c)] + s.nodes()[std::size_t(c) + 1]) / 2 / sum;
      };
      mass.push_back(0.02 / grid.cells + 0.98 * (a * part(bump) + b * part(line)) / total);
    }
    return mass;
  }
  SpectralGrid grid;
  SampledSpectrum bump, line;
};

TEST_P(Distribution, SampleHasItsDensity) {
  const SampledSpectrum spectra[] = {bump, line};
  const float weights[] = {1, 1};
  const WavelengthDistribution d(grid, spectra, weights);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  int at_edges = 0, count = 0;
  for (int k = 0; k < 20000; ++k) {
    const Wavelengths w = d.sample(k == 0 ? 0.f : k == 1 ? 0x1.fffffep-1f : uniform(random));
    for (int i = 0; i < kWavelengths; ++i) {
      ASSERT_GE(w.nm[i], float(grid.min_nm));
      ASSERT_LE(w.nm[i], float(grid.max_nm));
      ASSERT_GT(w.pdf[i], 0);
      ASSERT_TRUE(std::isfinite(w.pdf[i]));
      ++count;
      // A wavelength that is rounded to the edge of a piece belongs to both.
      if (std::abs(d.pdf(w.nm[i]) - w.pdf[i]) > 1e-4 * w.pdf[i]) ++at_edges;
      const Wavelengths again = Wavelengths::at(grid, w.nm);
      ASSERT_EQ(again.cell[i], w.cell[i]);
      ASSERT_EQ(again.fraction[i], w.fraction[i]);
    }
  }
  RecordProperty("at_edges_permille", at_edges * 1000 / count);

  EXPECT_LT(at_edges, 0.05 * count);
}

TEST_P(Distribution, HistogramFollowsTheMixture) {
  const SampledSpectrum spectra[] = {bump, line, SampledSpectrum::constant(grid, 0)};
  const float weights[] = {0.5f, 1.5f, 100.f};  // the black one does not count
  const WavelengthDistribution d(grid, spectra, weights);
  const std::vector<double> expected = mixture(0.5, 1.5);
  std::vector<double> found(expected.size());
  const int n = 1 << 18;
  for (int k = 0; k < n; ++k) {
    const Wavelengths w = d.sample((k + 0.5f) / n);
    for (int i = 0; i < kWavelengths; ++i) found[std::size_t(w.cell[i])] += 1.0 / n / kWavelengths;
  }
  // The inverse CDF has 2048 pieces: the distribution function errs by a piece at most.
  double below = 0, below_expected = 0, largest = 0;
  for (std::size_t c = 0; c < expected.size(); ++c) {
    below += found[c], below_expected += expected[c];
    largest = std::max(largest, std::abs(below - below_expected));
  }
  EXPECT_LT(largest, 1.5 / 2048);
  EXPECT_NEAR(below, 1, 1e-9);
}

TEST_P(Distribution, IntegralsAreUnbiased) {
  const SampledSpectrum spectra[] = {bump, line};
  const float weights[] = {0.5f, 0.5f};
  const WavelengthDistribution d(grid, spectra, weights);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<float> nodes(std::size_t(grid.cells) + 1);
  for (float& x : nodes) x = float(uniform(random));
  const SampledSpectrum rough(grid, nodes);
  for (const SampledSpectrum* s : std::initializer_list<const SampledSpectrum*>{&bump, &line, &rough}) {
    const int n = 1 << 17;
    double sum = 0, squares = 0;
    for (int k = 0; k < n; ++k) {
      const Wavelengths w = d.sample(float(uniform(random)));
      const Spectrum e = s->eval(w) / w.pdf * (1.f / kWavelengths);
      const double x = double(aureole::sum(e));
      sum += x, squares += x * x;
    }
    const double mean = sum / n, sigma = std::sqrt((squares / n - mean * mean) / n);
    EXPECT_NEAR(mean, s->integral(), 4.5 * sigma + 2e-5 * s->integral());
    EXPECT_LT(sigma, 0.01 * mean) << "a spectrum is not found";
  }
}

TEST_P(Distribution, RotatingTheOffsetPermutesTheWavelengths) {
  const SampledSpectrum spectra[] = {bump, line};
  const float weights[] = {0.5f, 0.5f};
  const WavelengthDistribution d(grid, spectra, weights);
  for (int k = 0; k < 1000; ++k) {
    const float u = float(k) / 1024 / kWavelengths;  // exact in float with j / N added
    const Wavelengths a = d.sample(u);
    for (int shift = 1; shift < kWavelengths; ++shift) {
      const Wavelengths b = d.sample(u + float(shift) / kWavelengths);
      for (int j = 0; j < kWavelengths; ++j) {
        ASSERT_EQ(b.nm[j], a.nm[(j + shift) % kWavelengths]);
        ASSERT_EQ(b.pdf[j], a.pdf[(j + shift) % kWavelengths]);
      }
    }
  }
}

TEST_P(Distribution, CoversTheWholeRange) {
  const SampledSpectrum spectra[] = {line};
  const float weights[] = {1};
  const WavelengthDistribution d(grid, spectra, weights);
  double integral = 0;
  const int n = 200000;
  float smallest = INFINITY;
  for (int k = 0; k < n; ++k) {
    const float p = d.pdf(float(grid.min_nm + (grid.max_nm - grid.min_nm) * (k + 0.5) / n));
    smallest = std::min(smallest, p);
    integral += p * (grid.max_nm - grid.min_nm) / n;
  }
  EXPECT_GT(smallest * (grid.max_nm - grid.min_nm), 0.01);
  EXPECT_NEAR(integral, 1, 0.05);
  EXPECT_EQ(d.pdf(std::nextafter(float(grid.min_nm), 0.f)), 0);
  EXPECT_EQ(d.pdf(std::nextafter(float(grid.max_nm), 2e9f)), 0);
  EXPECT_EQ(d.pdf(NAN), 0);
}

INSTANTIATE_TEST_SUITE_P(Ranges, Distribution,
                         ::testing::Values(Range{360, 830}, Range{8000, 14000}, Range{1e7, 1e9},
                                           Range{580, 600}, Range{589, 590}),
                         [](const auto& info) {
                           return "From" + std::to_string(int(info.param.low)) + "nm";
                         });

// A toy problem: L(lambda) = integral over [0, 1] of f(x, lambda). Two techniques, whose supports
// depend on the wavelength: the first has no density at all left of `start(lambda)`, the second is a density
// with a slope that depends on the wavelength, and none beyond an end for long waves. Together they cover all
// x for every wavelength.
struct Toy {
  static double start(double nm) { return nm < 500 ? 0.0 : 0.5; }
  static double end(double nm) { return nm < 600 ? 1.0 : 0.7; }
  static double p1(double x, double nm) { return x >= start(nm) ? 1 / (1 - start(nm)) : 0; }
  static double p2(double x, double nm) { return x < end(nm) ? 2 * x / (end(nm) * end(nm)) : 0; }
  static double sample1(double u, double nm) { return start(nm) + (1 - start(nm)) * u; }
  static double sample2(double u, double nm) { return end(nm) * std::sqrt(u); }
  static double f(double x, double nm) { return (1 + x) * x * (1 + std::sin(nm / 40)); }
  static double integral(double nm) { return (0.5 + 1.0 / 3) * (1 + std::sin(nm / 40)); }
};

TEST(PathDensity, IsUnbiasedForEveryWavelength) {
  const SpectralGrid grid = SpectralGrid::over(400, 700);
  const SampledSpectrum slope =
      SampledSpectrum::from_function(grid, [](double nm) { return 1 + 3 * (nm - 400) / 300; });
  const SampledSpectrum spectra[] = {slope};
  const float weights[] = {1};
  const WavelengthDistribution d(grid, spectra, weights);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  // Estimates of the integral of L over bands of 25 nm.
  constexpr int kBands = 12;
  double sums[kBands] = {}, squares[kBands] = {};
  const int n = 400000;
  for (int k = 0; k < n; ++k) {
    const Wavelengths w = d.sample(float(uniform(random)));
    double estimate[kBands] = {};
    for (int technique = 0; technique < 2; ++technique) {
      const double hero = double(w.nm[0]);
      const double x = technique ? Toy::sample2(uniform(random), hero) : Toy::sample1(uniform(random), hero);
      const auto densities = [&](int t) {
        return make_spectrum(
            [&](int i) { return float(t ? Toy::p2(x, double(w.nm[i])) : Toy::p1(x, double(w.nm[i]))); });
      };
      const Spectrum f = make_spectrum([&](int i) { return float(Toy::f(x, double(w.nm[i]))); });
      Connection connection;
      connection.near = Weight(f), connection.far = 1.f;
      connection.weigh(false, densities(technique), densities(1 - technique), w);
      const Spectrum c = connection.estimate();
      for (int i = 0; i < kWavelengths; ++i) {
        ASSERT_TRUE(std::isfinite(c[i]));
        estimate[std::clamp(int((w.nm[i] - 400) / 25), 0, kBands - 1)] += double(c[i]);
      }
    }
    for (int b = 0; b < kBands; ++b) sums[b] += estimate[b], squares[b] += estimate[b] * estimate[b];
  }
  for (int b = 0; b < kBands; ++b) {
    double expected = 0;
    for (int i = 0; i < 1000; ++i) expected += Toy::integral(400 + 25 * (b + (i + 0.5) / 1000)) * 25 / 1000;
    const double mean = sums[b] / n, sigma = std::sqrt((squares[b] / n - mean * mean) / n);
    EXPECT_NEAR(mean, expected, 4 * sigma) << "band " << b;
    EXPECT_LT(sigma, 0.03 * expected);
  }
}

// Two events, the first of which separates wavelengths: those that went elsewhere have zero value and density
// there, and the other way around some wavelengths have values but a density of zero for the hero's choice.
TEST(PathDensity, ChainOfEventsIsUnbiasedAndZerosPersist) {
  const SpectralGrid grid = SpectralGrid::over(400, 700);
  const SampledSpectrum spectra[] = {SampledSpectrum::constant(grid, 1)};
  const float weights[] = {1};
  const WavelengthDistribution d(grid, spectra, weights);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> uniform(0, 1);
  // Event 1: left or right, with f = 0.3 + left-right share of the wavelength; long waves never go left.
  const auto left_mass = [](double nm) { return nm > 550 ? 0.0 : 0.25 + (nm - 400) / 400; };
  const auto value = [&](bool left, double nm) { return left ? (nm > 550 ? 0.0 : 0.7) : 0.4; };
  // Event 2: x in [0, 1] with the density 1 + a (2x - 1) and f = x^2.
  const auto slope = [](double nm) { return (nm - 550) / 150; };
  const int n = 400000;
  constexpr int kBands = 6;
  double sums[kBands] = {}, squares[kBands] = {};
  for (int k = 0; k < n; ++k) {
    const Wavelengths w = d.sample(float(uniform(random)));
    const auto nm = [&](int i) { return double(w.nm[i]); };
    PathDensity path;
    const bool left = uniform(random) < left_mass(nm(0));
    path.extend(Weight(make_spectrum([&](int i) { return float(value(left, nm(i))); })),
                make_spectrum([&](int i) { return float(left ? left_mass(nm(i)) : 1 - left_mass(nm(i))); }),
                true);
    ASSERT_FLOAT_EQ(path.r_u[0], 1.f);
    for (int i = 0; i < kWavelengths; ++i)
      if (left && nm(i) > 550) {
        ASSERT_EQ(path.r_u[i], 0.f);
        ASSERT_EQ(path.beta.of(1.f)[i], 0.f);
      }
    // Invert the CDF x (1 - a) + a x^2 of the second event.
    const double a = slope(nm(0)), u = uniform(random);
    const double x = 2 * u / (1 - a + std::sqrt((1 - a) * (1 - a) + 4 * a * u));
    path.extend(Weight(float(x * x)),
                make_spectrum([&](int i) { return float(1 + slope(nm(i)) * (2 * x - 1)); }), false);
    if (left) {
      for (int i = 0; i < kWavelengths; ++i)
        if (nm(i) > 550) {
          ASSERT_EQ(path.r_u[i], 0.f) << "a ratio came back from zero";
        }
    }
    // Roulette that takes no side.
    const float survival = std::min(0.8f, path.hero_symmetric_throughput());
    Spectrum c = 0.f;
    if (uniform(random) < double(survival)) {
      path.survive(survival);
      c = path.contribution(2.f, w);
    }
    double estimate[kBands] = {};
    for (int i = 0; i < kWavelengths; ++i)
      estimate[std::clamp(int((w.nm[i] - 400) / 50), 0, kBands - 1)] += double(c[i]);
    for (int b = 0; b < kBands; ++b) sums[b] += estimate[b], squares[b] += estimate[b] * estimate[b];
  }
  for (int b = 0; b < kBands; ++b) {
    const double nm = 425 + 50 * b;
    const double expected = 50 * 2 * (value(true, nm) + value(false, nm)) / 3;
    const double mean = sums[b] / n, sigma = std::sqrt((squares[b] / n - mean * mean) / n);
    EXPECT_NEAR(mean, expected, 4 * sigma) << "band " << b;
    EXPECT_LT(sigma, 0.03 * expected);
  }
}

TEST(PathDensity, ThroughputForRouletteIsHeroSymmetric) {
  const Spectrum f[2] = {make_spectrum([](int i) { return 0.1f * float(i + 1); }),
                         make_spectrum([](int i) { return 1.f / float(i + 1); })};
  const Spectrum p[2] = {make_spectrum([](int i) { return 0.5f + 0.3f * float(i % 3); }),
                         make_spectrum([](int i) { return 2.f - 0.2f * float(i); })};
  PathDensity first;
  for (int e = 0; e < 2; ++e) first.extend(Weight(f[e]), p[e], false);
  for (int hero = 1; hero < kWavelengths; ++hero) {
    PathDensity other;
    for (int e = 0; e < 2; ++e)
      other.extend(Weight(make_spectrum([&](int i) { return f[e][(i + hero) % kWavelengths]; })),
                   make_spectrum([&](int i) { return p[e][(i + hero) % kWavelengths]; }), false);
    EXPECT_NEAR(other.hero_symmetric_throughput(), first.hero_symmetric_throughput(),
                1e-5 * first.hero_symmetric_throughput());
  }
}

}  // namespace
}  // namespace aureole
