// SPDX-License-Identifier: Apache-2.0
// Tables over angle and wavelength against interpolation by a search through the same numbers, and samples
// against the distribution function of the trapezoids.
#include "aureole/phase/table/tabulated_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace aureole {
namespace {

const SpectralGrid kGrid = SpectralGrid::over(400, 700);
const Vec3 kTravel = normalize(Vec3{0.3f, -0.5f, 0.8f});  ///< straight on
const Vec3 kAcross = normalize(cross(kTravel, {0, 0, 1}));

struct Numbers {
  std::vector<double> mu, nm, values;

  /// Linear in mu and in nm, over the integral of trapezoids at either wavelength.
  double eval(double at_mu, double at_nm) const {
    const std::size_t j = cell(nm, at_nm);
    const double t = nm.size() > 1 ? std::clamp((at_nm - nm[j]) / (nm[j + 1] - nm[j]), 0.0, 1.0) : 0;
    return (1 - t) * column(at_mu, j) + (t > 0 ? t * column(at_mu, j + 1) : 0);
  }
  double column(double at, std::size_t c) const {
    const std::size_t i = cell(mu, at);
    const double f = (at - mu[i]) / (mu[i + 1] - mu[i]);
    return ((1 - f) * value(i, c) + f * value(i + 1, c)) / integral(c, 1);
  }
  /// 2 pi times the integral from -1 to `end`, not normalised.
  double integral(std::size_t c, double end) const {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < mu.size() && mu[i] < end; ++i) {
      const double b = std::min(mu[i + 1], end), f = (b - mu[i]) / (mu[i + 1] - mu[i]);
      sum += 2 * M_PI * (b - mu[i]) * 0.5 * (value(i, c) + (1 - f) * value(i, c) + f * value(i + 1, c));
    }
    return sum;
  }
  double value(std::size_t i, std::size_t c) const { return values[i * nm.size() + c]; }

  static std::size_t cell(const std::vector<double>& nodes, double at) {
    const auto next = std::upper_bound(nodes.begin(), nodes.end(), at);
    const auto last = std::ptrdiff_t(nodes.size()) - 2;
    return std::size_t(
        std::clamp<std::ptrdiff_t>(next - nodes.begin() - 1, 0, std::max<std::ptrdiff_t>(last, 0)));
  }
  TabulatedPhase table() const { return TabulatedPhase(mu, nm, values, kGrid); }
};

/// A forward peak of a thousandth of a degree, a bow, and a glory; the bow moves with the wavelength. The
/// nodes of mu are uneven, and none of them is zero.
Numbers droplets() {
  Numbers n;
  n.nm = {400, 450, 520, 700};
  std::vector<double> angles = {0};
  for (double a = 2e-6; a < 0.02; a *= 1.15) angles.push_back(a);
  for (double a = 0.02; a < M_PI - 0.05; a += 0.0031) angles.push_back(a);
  for (double a = M_PI - 0.049; a < M_PI - 1e-5; a += 0.0009) angles.push_back(a);
  angles.push_back(M_PI);
  std::reverse(angles.begin(), angles.end());
  for (const double a : angles) {
    n.mu.push_back(std::cos(a));
    for (const double nm : n.nm) {
      const double peak = 1e9 * std::exp(-std::pow(a / 2e-5, 2)),
                   bow = (a - 2.4 - 0.0002 * (nm - 500)) / 0.01, glory = (M_PI - a - 0.01) / 0.004;
      n.values.push_back(peak + 0.1 + 5 * std::exp(-bow * bow) + 8 * std::exp(-glory * glory));
    }
  }
  n.mu.front() = -1, n.mu.back() = 1;
  return n;
}

/// At an angle, which is kept to 1e-7.
Vec3 direction(double angle) { return kTravel * float(std::cos(angle)) + kAcross * float(std::sin(angle)); }

TEST(TabulatedPhase, InterpolatesOverAngleAndWavelength) {
  const Numbers numbers = droplets();
  const TabulatedPhase table = numbers.table();
  const Wavelengths w = Wavelengths::at(kGrid, make_spectrum([](int i) { return 403.f + 41.f * float(i); }));
  for (double a = 0.0007; a < M_PI; a += 0.00173) {
    const Spectrum p = table.eval(-kTravel, direction(a), w);
    for (int j = 0; j < kWavelengths; ++j) {
      const double expected = numbers.eval(std::cos(a), double(w.nm[j]));
      ASSERT_NEAR(double(p[j]) / expected, 1, 2e-3) << a << " " << w.nm[j];
    }
  }
}

TEST(TabulatedPhase, KeepsAPeakOfAThousandthOfADegree) {
  const Numbers numbers = droplets();
  const TabulatedPhase table = numbers.table();
  const Wavelengths w = Wavelengths::at(kGrid, 450);
  const double top = numbers.eval(1, 450);
  for (const double a : {0.0, 5e-6, 1e-5, 2e-5, 4e-5})
    EXPECT_NEAR(double(table.eval(-kTravel, direction(a), w)[0]) / top, std::exp(-std::pow(a / 2e-5, 2)),
                0.02)
        << a;
}

TEST(TabulatedPhase, HoldsTheFunctionsOfItsEnds) {
  Numbers numbers;
  numbers.mu = {-1, 1}, numbers.nm = {500, 600}, numbers.values = {1, 1, 1, 3};
  const TabulatedPhase table = numbers.table();
  const double u = 1 / (4 * M_PI);
  const auto at = [&](float nm) {
    return double(table.eval(-kTravel, kTravel, Wavelengths::at(kGrid, nm))[0]);
  };
  EXPECT_NEAR(at(420), u, 1e-7);
  EXPECT_NEAR(at(550), (u + 1.5 * u) / 2, 1e-7);
  EXPECT_NEAR(at(690), 1.5 * u, 1e-7);
  EXPECT_NEAR(table.asymmetry(0), 0, 1e-12);
  EXPECT_NEAR(table.asymmetry(1), 1.0 / 6, 1e-8);  // the mean of mu (2 + mu)/4
}

TEST(TabulatedPhase, SamplesFollowTheDistribution) {
  // With equidistant random numbers the empirical distribution function is off by half a step at most, at a
  // wavelength between two nodes as at a node.
  const Numbers numbers = droplets();
  const TabulatedPhase table = numbers.table();
  constexpr int kSamples = 20000, kChoices = 8;
  for (const float nm : {450.f, 463.1f, 640.f}) {
    const Wavelengths w = Wavelengths::at(kGrid, nm);
    std::vector<double> mu;
    for (int i = 0; i < kSamples; ++i) {
      const float choice = (float(i % kChoices) + 0.5f) / kChoices;
      const auto s = table.sample(-kTravel, choice, {(float(i) + 0.5f) / kSamples, 0.3f}, w);
      mu.push_back(std::clamp(double(dot(s.wo, kTravel)), -1.0, 1.0));
      ASSERT_NEAR(length(s.wo), 1, 1e-5);
      if (i % 97 == 0) {
        // The value sampled with a direction is that of `eval` there; the peak is too narrow for directions
        // in single precision to show this to a part in a thousand.
        const Spectrum p = table.eval(-kTravel, s.wo, w);
        ASSERT_NEAR(double(p[0] / s.value[0]), 1, 0.02) << mu.back();
      }
    }
    std::sort(mu.begin(), mu.end());
    const std::size_t c = Numbers::cell(numbers.nm, double(nm));
    const double t = (double(nm) - numbers.nm[c]) / (numbers.nm[c + 1] - numbers.nm[c]);
    const double choices = std::round(t * kChoices) / kChoices;  // the shares that equidistant choices give
    double worst = 0;
    for (std::size_t i = 0; i < mu.size(); i += 50) {
      const double x = mu[i];
      if (x > 1 - 1e-6) break;  // the cosine does not resolve the peak
      const auto share = [&](std::size_t column) {
        return numbers.integral(column, x) / numbers.integral(column, 1);
      };
      const double expected = (1 - choices) * share(c) + (choices > 0 ? choices * share(c + 1) : 0);
      worst = std::max(worst, std::abs(expected - (double(i) + 0.5) / kSamples));
    }
    EXPECT_LT(worst, 1e-3) << nm;
  }
}

TEST(TabulatedPhase, SamplesThePeak) {
  // The share of the light within an angle of straight on, of a peak that is all there is.
  Numbers numbers;
  numbers.nm = {550};
  std::vector<double> angles = {0};
  for (double a = 1e-6; a < 0.01; a *= 1.1) angles.push_back(a);
  angles.insert(angles.end(), {0.1, 1.0, 2.0, M_PI});
  for (std::size_t i = angles.size(); i-- > 0;) {
    numbers.mu.push_back(std::cos(angles[i]));
    numbers.values.push_back(std::exp(-std::pow(angles[i] / 1e-4, 2)));
  }
  numbers.mu.front() = -1, numbers.mu.back() = 1;
  const TabulatedPhase table = numbers.table();
  const Wavelengths w = Wavelengths::at(kGrid, 550);
  constexpr int kSamples = 4000;
  for (const double a : {2e-5, 5e-5, 1e-4, 2e-4}) {
    int within = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto s =
          table.sample(-kTravel, 0.5f, {(float(i) + 0.5f) / kSamples, std::fmod(0.618f * float(i), 1.f)}, w);
      within += double(length(s.wo - kTravel)) < a;
    }
    EXPECT_NEAR(double(within) / kSamples, 1 - std::exp(-std::pow(a / 1e-4, 2)), 0.01) << a;
  }
}

TEST(TabulatedPhase, DrawsNothingWhereThereIsNothing) {
  Numbers numbers;
  numbers.mu = {-1, -0.4, -0.3, -0.2, 0.1, 1}, numbers.nm = {550}, numbers.values = {0, 0, 1, 0, 0, 0};
  const TabulatedPhase table = numbers.table();
  const Wavelengths w = Wavelengths::at(kGrid, 550);
  for (const float u : {0.f, 0x1p-24f, 0.25f, 0.5f, 0.75f, 0x1.fffffep-1f}) {
    const auto s = table.sample(-kTravel, 0.5f, {u, 0.1f}, w);
    EXPECT_GT(s.value[0], 0) << u;
    EXPECT_NEAR(dot(s.wo, kTravel), -0.3, 0.1001) << u;
  }
}

TEST(TabulatedPhase, RefusesWhatIsNoPhaseFunction) {
  const auto make = [](std::vector<double> mu, std::vector<double> nm, std::vector<double> values) {
    return Numbers{std::move(mu), std::move(nm), std::move(values)}.table();
  };
  EXPECT_THROW(make({-1, 1}, {500}, {1, -1}), std::domain_error);
  EXPECT_THROW(make({-1, 1}, {500}, {1, std::nan("")}), std::domain_error);
  EXPECT_THROW(make({-1, 1}, {500, 600}, {1, 0, 1, 0}), std::domain_error);
  EXPECT_THROW(make({-1, 0.5}, {500}, {1, 1}), std::logic_error);
  EXPECT_THROW(make({-1, 0, 0, 1}, {500}, {1, 1, 1, 1}), std::logic_error);
  EXPECT_THROW(make({-1, 1}, {600, 500}, {1, 1, 1, 1}), std::logic_error);
  EXPECT_THROW(make({-1, 1}, {500}, {1, 1, 1}), std::logic_error);
}

}  // namespace
}  // namespace aureole
