// SPDX-License-Identifier: Apache-2.0
// How finely the phase functions of spheres are tabulated for pictures.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/particle/ensemble.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Wavelengths at which phase functions of populations with these radii are tabulated, increasing and uniform
/// in 1/lambda, over the range of the grid: as many as the most demanding population needs, and at least
/// `least_per_unit_of_log` for each factor e of the wavelength. Throws std::domain_error where the effective radius
/// is too large for the shortest of them: time grows as the cube of their ratio.
std::vector<double> mie_wavelengths(const SpectralGrid& grid,
                                    std::span<const optics::RadiusDistribution> radii, double host_index,
                                    double least_per_unit_of_log = 9.6);

/// That exception alone.
void require_sizes_for_tables(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                              double host_index);

/// Coarser than the library's own: a part in a hundred of a phase function is not seen in a picture. `nm` is
/// the shortest wavelength.
optics::EnsembleAccuracy mie_accuracy(std::span<const optics::RadiusDistribution> radii, double host_index,
                                      double nm);

}  // namespace aureole
