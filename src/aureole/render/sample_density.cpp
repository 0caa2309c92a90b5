// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/sample_density.h"

#include <algorithm>
#include <cmath>

namespace aureole {

namespace {

constexpr int kReach = 3;  ///< half-width of the window [pixels]
/// Squared errors of stratified samples fall approximately as n^-1.5. So sum(variance n^-1.5) is least for n
/// proportional to variance^(1 / 2.5). Measured on two scenes, docs/decisions/0043-adaptive-densities.md.
constexpr double kPower = 0.4;
constexpr int kStepsPerOctave = 16;  ///< noise is sorted into logarithmic classes of this width
constexpr int kClasses =
    32 * kStepsPerOctave;  ///< classes below the noisiest pixel; the last one contains all lower noise

/// Averages over the neighbours of each pixel, in windows clipped to the picture.
std::vector<double> around(int width, int height, std::span<const PixelNoise> pixels,
                           float PixelNoise::*value) {
  const auto at = [width](int x, int y) { return size_t(y) * size_t(width) + size_t(x); };
  const auto window = [](int i, int n) {
    return std::pair(std::max(0, i - kReach), std::min(n - 1, i + kReach));
  };
  std::vector<double> rows(pixels.size()), result(pixels.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto [from, to] = window(x, width);
      for (int k = from; k <= to; ++k) rows[at(x, y)] += double(pixels[at(k, y)].*value);
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto [left, right] = window(x, width);
      const auto [top, bottom] = window(y, height);
      const int count = (right - left + 1) * (bottom - top + 1) - 1;
      // Sums without subtraction: subtracting a value much larger than the others would cancel all digits.
      double sum = 0;
      for (int k = top; k <= bottom; ++k) sum += k == y ? 0 : rows[at(x, k)];
      for (int k = left; k <= right; ++k) sum += k == x ? 0 : double(pixels[at(k, y)].*value);
      result[at(x, y)] = count > 0 ? sum / count : 0;
    }
  return result;
}

/// Exponent of the density of a class, given that the noisiest class has density 2^(top / kStepsPerOctave).
int exponent_of(int noise_class, int top) {
  const int e = int(std::floor(double(top - noise_class) / kStepsPerOctave + 0.5));
  return std::clamp(e, kMinDensityExponent, kMaxDensityExponent);
}

}  // namespace

std::vector<std::int8_t> sample_densities(int width, int height, std::span<const PixelNoise> pixels,
                                          AdaptiveTarget error) {
  std::vector<double> noise = around(width, height, pixels, &PixelNoise::variance);
  const std::vector<double> mean = around(width, height, pixels, &PixelNoise::mean);
  double picture_mean = 0;
  for (double m : mean) picture_mean += std::abs(m) / double(mean.size());
  // A fraction of the mean brightness is added, so that nearly black pixels do not dominate.
  const double dark = 0.1 * picture_mean;
  double most = 0;
  for (size_t i = 0; i < noise.size(); ++i) {
    const double level = std::abs(mean[i]) + dark;
    noise[i] = std::max(0.0, noise[i]);
    if (error == AdaptiveTarget::display && level > 0) noise[i] /= level;
    if (error == AdaptiveTarget::relative && level > 0) noise[i] /= level * level;
    noise[i] = std::pow(noise[i], kPower);
    most = std::max(most, noise[i]);
  }
  std::vector<std::int8_t> exponents(noise.size(), 0);
  if (!(most > 0) || !std::isfinite(most)) return exponents;

  std::vector<std::int64_t> count(kClasses, 0);
  std::vector<int> classes(noise.size());
  for (size_t i = 0; i < noise.size(); ++i) {
    const double below = noise[i] > 0 ? -std::log2(noise[i] / most) * kStepsPerOctave : kClasses;
    classes[i] = int(std::min(below, double(kClasses - 1)));
    ++count[size_t(classes[i])];
  }
  const auto samples = [&](int top) {
    double sum = 0;
    for (int c = 0; c < kClasses; ++c)
      if (count[size_t(c)]) sum += double(count[size_t(c)]) * std::ldexp(1.0, exponent_of(c, top));
    return sum;
  };
  // Bisection for the largest factor of the densities that the number of samples allows.
  int enough = kMinDensityExponent * kStepsPerOctave - 1,
      too_many = kClasses + kMaxDensityExponent * kStepsPerOctave;
  while (too_many - enough > 1) {
    const int top = (enough + too_many) / 2;
    (samples(top) <= double(noise.size()) ? enough : too_many) = top;
  }
  for (size_t i = 0; i < noise.size(); ++i) exponents[i] = std::int8_t(exponent_of(classes[i], enough));
  return exponents;
}

double mean_density(std::span<const std::int8_t> exponents) {
  if (exponents.empty()) return 1;
  double sum = 0;
  for (const std::int8_t e : exponents) sum += std::ldexp(1.0, e);
  return sum / double(exponents.size());
}

}  // namespace aureole
