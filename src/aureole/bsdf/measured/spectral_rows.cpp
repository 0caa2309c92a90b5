// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/spectral_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/wavelength_choice.h"

namespace aureole {
namespace {

/// For each wavelength, kWavelengths times the CDF of the density that a scene in daylight has for a colour film; of an even
/// density outside the visible.
std::vector<double> positions_in_sets(const SpectralGrid& grid, std::span<const float> nm) {
  const std::array<SampledSpectrum, 3> xyz = observer_xyz(grid);
  std::vector<float> response(xyz[0].nodes().size());
  for (const SampledSpectrum& channel : xyz)
    for (std::size_t i = 0; i < response.size(); ++i) response[i] += channel.nodes()[i];
  const SampledSpectrum light = d65_spectrum(grid, 1), even = SampledSpectrum::constant(grid, 1);
  const float one = 1;
  const WavelengthDistribution density =
      SampledSpectrum(grid, response).integral() > 0 && light.integral() > 0
          ? choose_wavelengths({grid, response}, xyz, {&light, 1})
          : WavelengthDistribution(grid, {&even, 1}, {&one, 1});
  std::vector<double> cdf(std::size_t(grid.cells) + 1);
  for (std::size_t i = 1; i < cdf.size(); ++i)
    cdf[i] = cdf[i - 1] + grid.step() * double(density.pdf(float(grid.node(int(i)) - 0.5 * grid.step())));
  std::vector<double> positions;
  for (const float x : nm) {
    const double cell = std::clamp((double(x) - grid.min_nm) / grid.step(), 0.0, double(grid.cells));
    const std::size_t i = std::min(std::size_t(cell), cdf.size() - 2);
    positions.push_back(kWavelengths * (cdf[i] + (cell - double(i)) * (cdf[i + 1] - cdf[i])) / cdf.back());
  }
  return positions;
}

}  // namespace

SpectralRows::SpectralRows(const SpectralGrid& grid, const SpectralNodes& nodes, std::size_t rows,
                           float maximum)
    : stride_((nodes.count() + std::size_t(kWavelengths) - 1) / std::size_t(kWavelengths) *
              std::size_t(kWavelengths)),
      slot_(nodes.count()) {
  const std::vector<double> position = positions_in_sets(grid, nodes.nm());
  std::vector<std::int32_t> order(nodes.count());
  std::iota(order.begin(), order.end(), 0);
  const auto within_interval = [&](std::int32_t i) {
    const double p = position[std::size_t(i)];
    return p - std::floor(p);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return within_interval(a) < within_interval(b); });
  for (std::size_t i = 0; i < order.size(); ++i) slot_[std::size_t(order[i])] = std::int32_t(i);
  words_ = int((stride_ / std::size_t(kWavelengths) + 63) / 64);
  const auto bit = [](std::int32_t slot) { return std::uint64_t(1) << (slot / kWavelengths % 64); };
  for (std::size_t i = 0; i + 1 < slot_.size(); ++i)
    pairs_.push_back({bit(slot_[i]) | bit(slot_[i + 1]), slot_[i], slot_[i + 1]});
#ifdef __F16C__
  // Numbers are scaled by a power of two, so that the largest one is at most 2^15 and small ones stay precise.
  int exponent = 0;
  if (maximum > 0) std::frexp(maximum, &exponent);
  unit_ = std::ldexp(1.f, std::max(exponent - 15, -126));
#else
  (void)maximum;
#endif
  values_ = LargeArray<Stored>(rows * stride_);
}

void SpectralRows::set(std::size_t row, std::span<const float> values) {
  Stored* const to = values_.data() + row * stride_;
  for (std::size_t i = 0; i < values.size(); ++i) {
#ifdef __F16C__
    to[slot_[i]] = Stored(_cvtss_sh(values[i] / unit_, _MM_FROUND_TO_NEAREST_INT));
#else
    to[slot_[i]] = values[i];
#endif
  }
}

}  // namespace aureole
