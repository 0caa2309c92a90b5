// SPDX-License-Identifier: Apache-2.0
// Resolution and accuracy of coefficients and phase functions of spheres that are tabulated for rendering.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "aureole/optics/particle/ensemble.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Coefficients and phase functions over the wavelengths of a film, computed where interpolation needs them.
struct MieSpectrum {
  /// Coefficients at increasing wavelengths, which are nodes of the grid.
  std::vector<optics::EnsembleCoefficients> coefficients;
  /// The wavelengths [nm], some of those of `coefficients`, at which phase functions are needed; between them
  /// phase functions are linear.
  std::vector<double> phase_nm;
  /// An estimate of the absorption coefficient that is cheap at each wavelength, such as
  /// `Suspension::straight_absorption`.
  optics::SpectralFunction estimated_absorption;

  /// Interpolated between the nodes: scattering as a power of the wavelength, absorption as such a power
  /// times its estimate.
  double scattering(double nm) const;
  double absorption(double nm) const;

private:
  std::pair<const optics::EnsembleCoefficients&, const optics::EnsembleCoefficients&> step_at(
      double nm) const;
};

/// Computes coefficients at some wavelengths, without phase tables.
using MieEvaluator = std::function<std::vector<optics::EnsembleCoefficients>(const std::vector<double>& nm)>;

/// Chooses the wavelengths for particles with these radii. Steps are halved (for the phase function and the
/// asymmetry of a spread of sizes once at most, since averages have some noise) until interpolation in their middle
/// is right to 1e-3 in scattering and absorption (or in 1e-4 of the extinction, if that is more), 2e-3 in the
/// asymmetry and, as far as `most_phases` allows, 1.5 % in the phase function at `Ensemble::probes`; or until
/// they are steps of the grid. Without `estimated_absorption` the phase function and the asymmetry alone count. Throws std::domain_error as `require_sizes_for_tables` does.
MieSpectrum mie_spectrum(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                         double host_index, const MieEvaluator& evaluate,
                         optics::SpectralFunction estimated_absorption = nullptr);

/// Throws std::domain_error if an effective radius is too large for the shortest wavelength: the time grows as
/// the cube of their ratio.
void require_sizes_for_tables(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                              double host_index);

/// Returns accuracy settings of tables for rendering. `nm` is the shortest wavelength.
optics::EnsembleAccuracy mie_accuracy(std::span<const optics::RadiusDistribution> radii, double host_index,
                                      double nm);

}  // namespace aureole
