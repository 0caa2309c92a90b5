// SPDX-License-Identifier: Apache-2.0
// Resolution and accuracy of the tabulated phase functions of spheres for rendering.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/particle/ensemble.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns the wavelengths [nm] at which phase functions of populations with these radii are tabulated. They
/// increase uniformly in 1/lambda over the range of the grid. The most demanding population sets their
/// number, with at least `least_per_unit_of_log` per factor e of the wavelength. Throws std::domain_error if
/// the effective radius is too large for the shortest wavelength: the time grows as the cube of their ratio.
std::vector<double> mie_wavelengths(const SpectralGrid& grid,
                                    std::span<const optics::RadiusDistribution> radii, double host_index,
                                    double least_per_unit_of_log = 9.6);

/// Throws std::domain_error as `mie_wavelengths` does, without computing wavelengths.
void require_sizes_for_tables(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                              double host_index);

/// Returns accuracy settings coarser than the default, since errors of 1 % of a phase function are not
/// visible in a picture. `nm` is the shortest wavelength.
optics::EnsembleAccuracy mie_accuracy(std::span<const optics::RadiusDistribution> radii, double host_index,
                                      double nm);

}  // namespace aureole
