// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/wavelength_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace aureole {

namespace {

/// Convolved with a Gaussian of standard deviation `nm`; the ends continue beyond the range.
SampledSpectrum smoothed(const SampledSpectrum& s, double nm) {
  // A wider kernel would give a constant all the same, and take long.
  nm = std::min(nm, s.grid().max_nm - s.grid().min_nm);
  const int reach = int(std::ceil(3.5 * nm / s.grid().step()));
  std::vector<double> kernel(size_t(reach) + 1);
  double total = 0;
  for (int k = 0; k <= reach; ++k) {
    const double x = k * s.grid().step() / nm;
    kernel[size_t(k)] = std::exp(-0.5 * x * x);
    total += kernel[size_t(k)] * (k == 0 ? 1 : 2);
  }
  const auto nodes = s.nodes();
  const int n = int(nodes.size());
  std::vector<float> result(nodes.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int k = -reach; k <= reach; ++k)
      sum += kernel[size_t(std::abs(k))] * nodes[size_t(std::clamp(i + k, 0, n - 1))];
    result[size_t(i)] = float(sum / total);
  }
  return {s.grid(), std::move(result)};
}

/// Mean with weight 1 for every spectrum that is not black, each scaled to unit integral.
SampledSpectrum normalized_mean(std::span<const SampledSpectrum> spectra) {
  std::vector<float> nodes(spectra[0].nodes().size());
  for (const SampledSpectrum& s : spectra) {
    const double integral = s.integral();
    if (!(integral > 0)) continue;
    for (size_t i = 0; i < nodes.size(); ++i) nodes[i] += float(s.nodes()[i] / integral);
  }
  return {spectra[0].grid(), std::move(nodes)};
}

/// The light that strongly coloured surfaces, a red, a blue and a green one, reflect.
std::array<SampledSpectrum, 3> reflected(const SampledSpectrum& light) {
  const auto step = [](double x) { return 1 / (1 + std::exp(-x)); };
  const auto times = [&](auto&& reflectance) {
    return product(light, SampledSpectrum::from_function(light.grid(), reflectance));
  };
  return {times([&](double nm) { return step((nm - 590) / 10); }),
          times([&](double nm) { return step((500 - nm) / 10); }),
          times([&](double nm) { return std::exp(-0.5 * (nm - 530) * (nm - 530) / 900); })};
}

/// As seen through the film's response: integral 1 or, of a light without, black.
SampledSpectrum of_unit_strength(const SampledSpectrum& light, double strength) {
  std::vector<float> nodes(light.nodes().begin(), light.nodes().end());
  // Wavelengths that the film hardly sees may be stronger by any factor than those that it sees.
  for (float& x : nodes) x = strength > 0 ? float(std::min(1e18, double(x) / strength)) : 0.f;
  return {light.grid(), std::move(nodes)};
}

/// All that variances between sets are computed from, sampled once per density.
struct Sets {
  static constexpr int kCount = 256;
  std::vector<Wavelengths> wavelengths;

  explicit Sets(const WavelengthDistribution& distribution) {
    for (int k = 0; k < kCount; ++k)
      wavelengths.push_back(distribution.sample((float(k) + 0.5f) / kCount, 0));
  }

  struct Moments {
    double variance = 0, squared_mean = 0;  ///< summed over the channels
  };
  Moments moments(std::span<const SampledSpectrum> channels, const SampledSpectrum& light) const {
    Spectrum estimates[kCount];
    for (int k = 0; k < kCount; ++k)
      estimates[k] = light.eval(wavelengths[size_t(k)]) / (wavelengths[size_t(k)].pdf * float(kWavelengths));
    Moments m;
    for (const SampledSpectrum& channel : channels) {
      double sum1 = 0, sum2 = 0;
      for (int k = 0; k < kCount; ++k) {
        const double x = sum(estimates[k] * channel.eval(wavelengths[size_t(k)]));
        sum1 += x, sum2 += x * x;
      }
      const double mean = sum1 / kCount;
      m.variance += std::max(0.0, sum2 / kCount - mean * mean);
      m.squared_mean += mean * mean;
    }
    return m;
  }
};

/// Beyond so many lights only the strongest count; of so many channels only all lights together.
constexpr size_t kLights = 8, kChannels = 8;

/// The densities best for single wavelengths: the film's response mixed with its product with all light, or
/// with each light.
std::vector<SampledSpectrum> sharp_densities(const SampledSpectrum& response, const SampledSpectrum& all,
                                             std::span<const SampledSpectrum> lights) {
  const SampledSpectrum by_power[2] = {response, product(response, all)};
  std::vector<SampledSpectrum> sharp = {normalized_mean(by_power)};
  if (lights.size() < 2) return sharp;
  std::vector<SampledSpectrum> seen;
  for (const SampledSpectrum& light : lights) seen.push_back(product(response, light));
  const SampledSpectrum by_light[2] = {response, normalized_mean(seen)};
  sharp.push_back(normalized_mean(by_light));
  return sharp;
}

}  // namespace

double variance_between_sets(const WavelengthDistribution& distribution,
                             std::span<const SampledSpectrum> channels, const SampledSpectrum& light) {
  const Sets::Moments m = Sets(distribution).moments(channels, light);
  return m.variance / m.squared_mean;
}

WavelengthDistribution choose_wavelengths(const SampledSpectrum& response,
                                          std::span<const SampledSpectrum> channels,
                                          std::span<const SampledSpectrum> lights) {
  const SpectralGrid& grid = response.grid();
  std::vector<std::pair<double, const SampledSpectrum*>> order;
  double total = 0;
  for (const SampledSpectrum& light : lights)
    if (const double s = overlap(light, response); s > 0) order.push_back({s, &light}), total += s;
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<float> sum(size_t(grid.cells) + 1);
  std::vector<SampledSpectrum> shining;
  for (const auto& [strength, light] : order) {
    const SampledSpectrum share = of_unit_strength(*light, total);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += share.nodes()[i];
    if (shining.size() < kLights) shining.push_back(of_unit_strength(*light, strength));
  }
  const SampledSpectrum all(grid, std::move(sum));
  const std::vector<SampledSpectrum> sharp = sharp_densities(response, all, shining);
  if (shining.empty()) shining.push_back(SampledSpectrum::constant(grid, 1));
  const bool many_channels = channels.size() > kChannels;
  if (many_channels && !order.empty()) shining = {all};

  std::optional<WavelengthDistribution> best;
  double least = 0;
  const auto consider = [&](const SampledSpectrum& narrow, const SampledSpectrum& wide, float part) {
    const SampledSpectrum densities[2] = {narrow, wide};
    const float weights[2] = {part, 1 - part};
    WavelengthDistribution distribution(grid, densities, weights);
    const Sets sets(distribution);
    double variance = 0;
    for (const SampledSpectrum& light : shining) {
      const Sets::Moments whole = sets.moments(channels, light);
      if (!(whole.squared_mean > 0)) continue;
      double sum = whole.variance;
      if (!many_channels)
        for (const SampledSpectrum& rest : reflected(light)) sum += sets.moments(channels, rest).variance;
      variance += sum / whole.squared_mean;
    }
    if (!best || variance < least) best = std::move(distribution), least = variance;
  };
  for (const SampledSpectrum& s : sharp) {
    consider(s, s, 1);
    for (const double nm : {5., 10., 20., 30., 40., 60., 80., 120.}) {
      const SampledSpectrum wide = smoothed(s, nm);
      for (const float part : {0.f, 0.2f, 0.5f, 0.8f}) consider(s, wide, part);
    }
  }
  return std::move(*best);
}

}  // namespace aureole
