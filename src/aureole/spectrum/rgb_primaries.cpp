// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/rgb_primaries.h"

#include <iterator>
#include <vector>

namespace aureole {
namespace {
#include "aureole/spectrum/data/rgb_primaries.inc"
}  // namespace

std::array<SampledSpectrum, 3> rgb_primaries(const SpectralGrid& grid) {
  std::vector<double> nm(std::size(kRgbPrimaries[0]));
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = kRgbPrimariesStart + kRgbPrimariesStep * double(i);
  std::array<SampledSpectrum, 3> spectra;
  for (std::size_t c = 0; c < 3; ++c)
    spectra[c] = SampledSpectrum::from_points(grid, nm, kRgbPrimaries[c], SpectrumEnds::held);
  return spectra;
}

}  // namespace aureole
