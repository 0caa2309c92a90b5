// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/wavelength_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace aureole {

namespace {

/// Returns the spectrum convolved with a Gaussian of standard deviation `nm`; beyond the range it keeps the
/// value at the limit.
SampledSpectrum smoothed(const SampledSpectrum& s, double nm) {
  // The width is limited, since a wider kernel would take long and also give a constant.
  nm = std::min(nm, s.grid().max_nm - s.grid().min_nm);
  const int reach = int(std::ceil(3.5 * nm / s.grid().step()));
  std::vector<double> kernel(size_t(reach) + 1);
  double total = 0;
  for (int k = 0; k <= reach; ++k) {
    const double x = k * s.grid().step() / nm;
    kernel[size_t(k)] = std::exp(-0.5 * x * x);
    total += kernel[size_t(k)] * (k == 0 ? 1 : 2);
  }
  const int n = int(s.nodes().size());
  // nodes of the spectrum, which begin `reach` nodes before the grid
  std::vector<double> nodes(size_t(n + 2 * reach));
  for (int i = 0; i < n + 2 * reach; ++i)
    nodes[size_t(i)] = double(s.nodes()[size_t(std::clamp(i - reach, 0, n - 1))]);
  std::vector<double> sums(static_cast<size_t>(n));
  for (int k = -reach; k <= reach; ++k) {
    const double weight = kernel[size_t(std::abs(k))], *from = &nodes[size_t(k + reach)];
    for (int i = 0; i < n; ++i) sums[size_t(i)] += weight * from[i];
  }
  std::vector<float> result(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) result[size_t(i)] = float(sums[size_t(i)] / total);
  return {s.grid(), std::move(result)};
}

/// Weighted mean of the spectra that are not black, each scaled to unit integral.
SampledSpectrum normalized_mean(std::span<const SampledSpectrum> spectra, std::span<const double> weights) {
  std::vector<float> nodes(spectra[0].nodes().size());
  for (size_t k = 0; k < spectra.size(); ++k) {
    const double integral = spectra[k].integral();
    if (!(integral > 0)) continue;
    for (size_t i = 0; i < nodes.size(); ++i)
      nodes[i] += float(weights[k] * spectra[k].nodes()[i] / integral);
  }
  return {spectra[0].grid(), std::move(nodes)};
}

/// Returns the light reflected by strongly coloured surfaces: a red, a blue and a green one.
std::array<SampledSpectrum, 3> reflected(const SampledSpectrum& light) {
  const auto step = [](double x) { return 1 / (1 + std::exp(-x)); };
  const auto times = [&](auto&& reflectance) {
    return product(light, SampledSpectrum::from_function(light.grid(), reflectance));
  };
  return {times([&](double nm) { return step((nm - 590) / 10); }),
          times([&](double nm) { return step((500 - nm) / 10); }),
          times([&](double nm) { return std::exp(-0.5 * (nm - 530) * (nm - 530) / 900); })};
}

/// Returns the light divided by `strength`, the integral of light times response; black where `strength` is
/// zero.
SampledSpectrum of_unit_strength(const SampledSpectrum& light, double strength) {
  std::vector<float> nodes(light.nodes().begin(), light.nodes().end());
  // Limits the values, which may be arbitrarily large at wavelengths where the film's response is nearly
  // zero.
  for (float& x : nodes) x = strength > 0 ? float(std::min(1e18, double(x) / strength)) : 0.f;
  return {light.grid(), std::move(nodes)};
}

/// The sets of wavelengths that one density generates. `factors_` are the contributions of a light of 1 per
/// nm at each wavelength to the estimate of each channel.
class Sets {
public:
  Sets(const WavelengthDistribution& distribution, std::span<const SampledSpectrum> channels)
      : channels_(channels.size()), values_(kCount) {
    wavelengths_.reserve(kCount);
    factors_.reserve(kCount * channels_);
    for (int k = 0; k < kCount; ++k) {
      const Wavelengths& w = wavelengths_.emplace_back(distribution.sample((float(k) + 0.5f) / kCount, 0));
      for (const SampledSpectrum& channel : channels)
        factors_.push_back(channel.eval(w) / (w.pdf * float(kWavelengths)));
    }
  }

  struct Moments {
    double variance = 0, squared_mean = 0;  ///< variance and squared mean, summed over the channels
  };
  Moments moments(const SampledSpectrum& light) {
    for (size_t k = 0; k < kCount; ++k) values_[k] = light.eval(wavelengths_[k]);
    Moments m;
    for (size_t c = 0; c < channels_; ++c) {
      double sum1 = 0, sum2 = 0;
      for (int k = 0; k < kCount; ++k) {
        const double x = sum(values_[size_t(k)] * factors_[size_t(k) * channels_ + c]);
        sum1 += x, sum2 += x * x;
      }
      const double mean = sum1 / kCount;
      m.variance += std::max(0.0, sum2 / kCount - mean * mean);
      m.squared_mean += mean * mean;
    }
    return m;
  }

private:
  static constexpr int kCount = 256;
  std::vector<Wavelengths> wavelengths_;
  size_t channels_;
  std::vector<Spectrum> factors_;  ///< factors for each set of wavelengths, for all channels
  std::vector<Spectrum> values_;   ///< temporary storage: a light at the wavelengths of each set
};

/// With more than kLights different lights, the most similar ones are merged; with more than kChannels
/// channels, only the sum of all lights is used.
constexpr size_t kLights = 16, kChannels = 8;

/// Returns the distance of two lights of unit strength: 0 if they are equal, 2 if their spectra do not
/// overlap.
double difference(const SampledSpectrum& a, const SampledSpectrum& b) {
  double sum = 0, whole = 0;
  for (size_t i = 0; i < a.nodes().size(); ++i) {
    sum += std::abs(double(a.nodes()[i]) - double(b.nodes()[i]));
    whole += double(a.nodes()[i]) + double(b.nodes()[i]);
  }
  return whole > 0 ? 2 * sum / whole : 0;
}

/// A light of unit strength, or the sum of several similar ones.
struct LightKind {
  SampledSpectrum light;
  double count = 1;
  std::vector<SampledSpectrum> seen = {};  ///< product of response and light, for the first few lights of
                                           ///< this kind
};

/// Adds a light unless a similar one is known; if there are kLights kinds already, adds it to the nearest
/// one.
void add_if_different(std::vector<LightKind>& kinds, const SampledSpectrum& light,
                      const SampledSpectrum& response) {
  constexpr double kAlike = 1e-3, kNothingInCommon = 2;
  constexpr size_t kMaxCompared = 8;  // upper bound of the compared lights per kind
  const SampledSpectrum seen = product(response, light);
  LightKind* nearest = nullptr;
  double least = kNothingInCommon;
  for (LightKind& kind : kinds) {
    double d = kNothingInCommon;
    for (const SampledSpectrum& known : kind.seen) d = std::min(d, difference(known, seen));
    if (d < kAlike) return;
    // Among kinds that do not overlap with the light, takes the one with the fewest lights.
    if (!nearest || d < least || (d == least && kind.count < nearest->count)) nearest = &kind, least = d;
  }
  if (kinds.size() < kLights) {
    kinds.push_back({light, 1, {seen}});
    return;
  }
  if (nearest->seen.size() < kMaxCompared) nearest->seen.push_back(seen);
  std::vector<float> nodes(nearest->light.nodes().begin(), nearest->light.nodes().end());
  for (size_t i = 0; i < nodes.size(); ++i) nodes[i] += light.nodes()[i];
  nearest->light = {light.grid(), std::move(nodes)};
  nearest->count += 1;
}

/// The densities that are best for single wavelengths: the film's response mixed with its product with the
/// sum of all lights, and with its mean product with the single lights.
std::vector<SampledSpectrum> sharp_densities(const SampledSpectrum& response, const SampledSpectrum& all,
                                             std::span<const LightKind> lights) {
  const SampledSpectrum by_power[2] = {response, product(response, all)};
  const double equal[2] = {1, 1};
  std::vector<SampledSpectrum> sharp = {normalized_mean(by_power, equal)};
  if (lights.size() < 2) return sharp;
  std::vector<SampledSpectrum> seen;
  std::vector<double> counts;
  for (const LightKind& kind : lights) {
    seen.push_back(product(response, kind.light));
    counts.push_back(kind.count);
  }
  const SampledSpectrum by_light[2] = {response, normalized_mean(seen, counts)};
  sharp.push_back(normalized_mean(by_light, equal));
  return sharp;
}

/// Evaluates mixtures of densities and keeps the one with the least variance.
class Contest {
public:
  Contest(const SpectralGrid& grid, std::span<const SampledSpectrum> channels, bool with_surfaces,
          std::span<const LightKind> lights)
      : grid_(grid), channels_(channels) {
    for (const LightKind& kind : lights) {
      Judged& j = judged_.emplace_back(Judged{kind, {}});
      if (with_surfaces)
        for (SampledSpectrum& rest : reflected(kind.light)) j.reflected.push_back(std::move(rest));
    }
  }

  struct Mixture {
    std::vector<SampledSpectrum> densities;
    std::vector<float> weights;
  };
  /// Returns whether the variance of this mixture is below `part` times the least variance so far; if so,
  /// keeps it.
  bool judge(const Mixture& mixture, double part = 1) {
    WavelengthDistribution distribution(grid_, mixture.densities, mixture.weights);
    Sets sets(distribution, channels_);
    double variance = 0;
    for (const Judged& j : judged_) {
      const Sets::Moments whole = sets.moments(j.kind.light);
      if (!(whole.squared_mean > 0)) continue;
      double sum = whole.variance;
      for (const SampledSpectrum& rest : j.reflected) sum += sets.moments(rest).variance;
      variance += j.kind.count * sum / whole.squared_mean;
    }
    if (best_ && !(variance < part * least_)) return false;
    best_ = std::move(distribution), least_ = variance, mixture_ = mixture;
    return true;
  }
  const Mixture& best_mixture() const { return mixture_; }
  WavelengthDistribution take_best() { return std::move(*best_); }

private:
  /// A light and its reflections from coloured surfaces.
  struct Judged {
    LightKind kind;
    std::vector<SampledSpectrum> reflected;
  };
  SpectralGrid grid_;
  std::span<const SampledSpectrum> channels_;
  std::vector<Judged> judged_;
  std::optional<WavelengthDistribution> best_;
  Mixture mixture_;
  double least_ = 0;
};

/// Raises or lowers the weights of single lights as long as that reduces the variance. A spectral line needs
/// one wavelength of each set; with several lights, equal weights may give it less than that.
void share_out(Contest& contest, const SampledSpectrum& response, std::span<const LightKind> lights) {
  constexpr double kWorthwhile = 0.995;
  Contest::Mixture trial = contest.best_mixture();
  const size_t first = trial.weights.size();
  for (const LightKind& kind : lights) {
    trial.densities.push_back(product(response, kind.light));
    trial.weights.push_back(0);
  }
  for (const float step : {0.1f, 0.03f})
    for (size_t k = first; k < trial.weights.size(); ++k)
      for (const float change : {step, -step}) {
        const float before = trial.weights[k];
        float kept = before;
        while (kept + change >= 0) {
          trial.weights[k] = kept + change;
          if (!contest.judge(trial, kWorthwhile)) break;
          kept = trial.weights[k];
        }
        trial.weights[k] = kept;
        if (kept != before) break;
      }
}

}  // namespace

double variance_between_sets(const WavelengthDistribution& distribution,
                             std::span<const SampledSpectrum> channels, const SampledSpectrum& light) {
  const Sets::Moments m = Sets(distribution, channels).moments(light);
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
  std::vector<LightKind> shining;
  for (const auto& [strength, light] : order) {
    const SampledSpectrum share = of_unit_strength(*light, total);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += share.nodes()[i];
    add_if_different(shining, of_unit_strength(*light, strength), response);
  }
  const SampledSpectrum all(grid, std::move(sum));
  const std::vector<SampledSpectrum> sharp = sharp_densities(response, all, shining);
  if (shining.empty()) shining.push_back({SampledSpectrum::constant(grid, 1)});
  const bool many_channels = channels.size() > kChannels;
  if (many_channels && !order.empty()) shining = {{all}};

  Contest contest(grid, channels, !many_channels, shining);
  for (const SampledSpectrum& s : sharp) {
    contest.judge({{s}, {1}});
    for (const double nm : {5., 10., 20., 30., 40., 60., 80., 120.}) {
      const SampledSpectrum wide = smoothed(s, nm);
      for (const float part : {0.f, 0.2f, 0.5f, 0.8f}) contest.judge({{s, wide}, {part, 1 - part}});
    }
  }
  if (shining.size() > 1) share_out(contest, response, shining);
  return contest.take_best();
}

}  // namespace aureole
