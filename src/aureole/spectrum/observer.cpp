// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/observer.h"

#include <mutex>
#include <optional>
#include <utility>

#include "aureole/spectrum/tables.h"

namespace aureole {

std::array<SampledSpectrum, 3> observer_xyz(const SpectralGrid& grid) {
  const Observer& observer = cie_1931_observer();
  std::vector<double> nm(observer.y.size());
  for (size_t i = 0; i < nm.size(); ++i) nm[i] = observer.start_nm + observer.step_nm * double(i);
  std::array<SampledSpectrum, 3> xyz;
  const std::span<const double> values[3] = {observer.x, observer.y, observer.z};
  for (size_t c = 0; c < 3; ++c) {
    xyz[c] = SampledSpectrum::from_points(grid, nm, values[c]);
    xyz[c].scale(float(1 / cie_y_integral()));
  }
  return xyz;
}

SampledSpectrum d65_spectrum(const SpectralGrid& grid, double scale) {
  // The table is kept, since scenes have thousands of emitters with colours, on one grid.
  static std::mutex mutex;
  static std::optional<std::pair<SpectralGrid, SampledSpectrum>> last;
  SampledSpectrum s;
  {
    const std::lock_guard lock(mutex);
    if (!last || !(last->first == grid)) {
      const TabulatedSpectrum d65 = *find_illuminant("D65");
      last.emplace(grid, SampledSpectrum::from_points(grid, d65.wavelengths_nm, d65.values));
    }
    s = last->second;
  }
  s.scale(float(scale * d65_whitepoint_normalization()));
  return s;
}

void xyz_to_srgb(const double* v, float rgb[3]) {
  rgb[0] = float(3.2404542 * v[0] - 1.5371385 * v[1] - 0.4985314 * v[2]);
  rgb[1] = float(-0.9692660 * v[0] + 1.8760108 * v[1] + 0.0415560 * v[2]);
  rgb[2] = float(0.0556434 * v[0] - 0.2040259 * v[1] + 1.0572252 * v[2]);
}

}  // namespace aureole
