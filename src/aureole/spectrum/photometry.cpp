// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/photometry.h"

#include <iterator>
#include <vector>

#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {

namespace {

#include "aureole/spectrum/data/cie_1951_scotopic.inc"
#include "aureole/spectrum/data/cie_1988_modified_photopic.inc"

/// A table with a value for each nm, times a factor, on a grid.
template <std::size_t kCount>
SampledSpectrum efficacy_of(const SpectralGrid& grid, double start_nm, const double (&table)[kCount],
                            double factor) {
  std::vector<double> nm(kCount);
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = start_nm + double(i);
  SampledSpectrum v = SampledSpectrum::from_points(grid, nm, table);
  v.scale(float(factor));
  return v;
}

}  // namespace

SampledSpectrum photopic_efficacy(const SpectralGrid& grid) {
  SampledSpectrum v = observer_xyz(grid)[1];
  v.scale(float(kPhotopicEfficacy * cie_y_integral()));
  return v;
}

SampledSpectrum scotopic_efficacy(const SpectralGrid& grid) {
  return efficacy_of(grid, kScotopicStart, kScotopic, kScotopicEfficacy);
}

SampledSpectrum modified_photopic_efficacy(const SpectralGrid& grid) {
  return efficacy_of(grid, kModifiedPhotopicStart, kModifiedPhotopic, kPhotopicEfficacy);
}

SampledSpectrum mesopic_efficacy(const SpectralGrid& grid, double m) {
  constexpr double kScotopicAt555 = 683.0 / 1699;
  const double rest = (1 - m) * kScotopicAt555, total = m + rest;
  const SampledSpectrum photopic = photopic_efficacy(grid), scotopic = scotopic_efficacy(grid);
  std::vector<float> nodes;
  for (std::size_t i = 0; i < photopic.nodes().size(); ++i)
    nodes.push_back(float((m * double(photopic.nodes()[i]) + rest * double(scotopic.nodes()[i])) / total));
  return {grid, std::move(nodes)};
}

SampledSpectrum photons_per_joule(const SpectralGrid& grid) {
  return SampledSpectrum::from_function(
      grid, [](double nm) { return 1e6 * nm * 1e-9 / (kPlanckTimesLight * kAvogadro); });
}

bool covers_photopic_vision(const SpectralGrid& grid) { return observer_xyz(grid)[1].integral() > 0.999; }

}  // namespace aureole
