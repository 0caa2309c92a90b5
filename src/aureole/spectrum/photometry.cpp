// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/photometry.h"

#include <iterator>
#include <vector>

#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {

namespace {

#include "aureole/spectrum/data/cie_1951_scotopic.inc"

}  // namespace

SampledSpectrum photopic_efficacy(const SpectralGrid& grid) {
  SampledSpectrum v = observer_xyz(grid)[1];
  v.scale(float(kPhotopicEfficacy * cie_y_integral()));
  return v;
}

SampledSpectrum scotopic_efficacy(const SpectralGrid& grid) {
  std::vector<double> nm(std::size(kScotopic));
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = kScotopicStart + double(i);
  SampledSpectrum v = SampledSpectrum::from_points(grid, nm, kScotopic);
  v.scale(float(kScotopicEfficacy));
  return v;
}

SampledSpectrum photons_per_joule(const SpectralGrid& grid) {
  return SampledSpectrum::from_function(
      grid, [](double nm) { return 1e6 * nm * 1e-9 / (kPlanckTimesLight * kAvogadro); });
}

bool covers_photopic_vision(const SpectralGrid& grid) { return observer_xyz(grid)[1].integral() > 0.999; }

}  // namespace aureole
