// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/intensity_map.h"

#include <algorithm>
#include <cmath>

namespace aureole::optics {

IntensityMap::IntensityMap(const std::function<MixtureIntensity(double, double)>& f, double extent,
                           const ParallelFor& parallel_for) {
  const double outer = std::clamp(std::ceil(extent) + 1, 80.0, double(kLargestExtent));
  const double extents[kLevels] = {8, 16, 32, 64, outer}, rates[kLevels] = {20, 16, 12, 5, 2};
  int total = 0, rows[kLevels];
  for (int l = 0; l < kLevels; ++l) {
    const int half = int(extents[l] * rates[l]);
    extents_[l] = float(extents[l]), rates_[l] = float(rates[l]);
    columns_[l] = 2 * half + 4, rows[l] = half + 4;
    first_[l] = total;
    total += columns_[l] * rows[l];
  }
  nodes_.resize(std::size_t(total));
  for (int l = 0; l < kLevels; ++l) {
    const int half = int(extents[l] * rates[l]);
    // inside this extent a finer level is used
    const double inner = l > 0 ? extents[l - 1] - 2 / rates[l] : -1;
    parallel_for(
        std::size_t(rows[l]),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row)
            for (int column = 0; column < columns_[l]; ++column) {
              const double x = (column - half - 1) / rates[l], y = (double(row) - 1) / rates[l];
              if (std::abs(x) < inner && std::abs(y) < inner) continue;
              const MixtureIntensity m = f(x, y);
              nodes_[std::size_t(first_[l]) + row * std::size_t(columns_[l]) + std::size_t(column)] = {
                  float(m.uncorrelated), float(m.coherent)};
            }
        },
        4);
  }
}

void IntensityMap::eval(std::span<const double> x, std::span<const double> y,
                        std::span<double> values) const {
  constexpr std::size_t kAtOnce = 8;
  for (std::size_t begin = 0; begin < x.size(); begin += kAtOnce) {
    const std::size_t n = std::min(kAtOnce, x.size() - begin);
    float ux[kAtOnce] = {}, uy[kAtOnce] = {}, uncorrelated[kAtOnce], coherent[kAtOnce];
    for (std::size_t i = 0; i < n; ++i) ux[i] = float(x[begin + i]), uy[i] = float(y[begin + i]);
    eval<kAtOnce>(ux, uy, uncorrelated, coherent);
    for (std::size_t i = 0; i < n; ++i) {
      values[begin + i] = double(uncorrelated[i]);
      values[x.size() + begin + i] = double(coherent[i]);
    }
  }
}

}  // namespace aureole::optics
