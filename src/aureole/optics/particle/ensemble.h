// SPDX-License-Identifier: Apache-2.0
// Scattering and absorption by many particles of several kinds and sizes, over wavelengths: coefficients and
// phase functions. Intensities of particles add. For dense particles, whose positions are correlated, they
// are multiplied by a structure factor.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/particle/particle.h"
#include "aureole/optics/particle/phase_table.h"
#include "aureole/optics/particle/radius_distribution.h"

namespace aureole::optics {

/// Particles of one kind with a distribution of sizes, and their number density.
struct ParticlePopulation {
  std::shared_ptr<const ParticleKind> kind;
  RadiusDistribution radii;
  double number_density = 1;  ///< per m^3

  /// Returns the fraction of the total volume that the particles fill.
  double volume_fraction() const { return number_density * radii.mean_volume(); }

  /// Whether positions are those of hard spheres of the population's own volume fraction. Each size is
  /// multiplied by the structure factor of equal spheres of that size (local monodisperse approximation;
  /// Pedersen, J. Appl. Cryst. 27 (1994) 595). Different populations are uncorrelated.
  bool hard_spheres = false;
};

struct EnsembleAccuracy {
  /// The number of radii is doubled until cross sections and asymmetry change by at most `averaging`, and the
  /// phase function at 28 angles by at most `phase_averaging` (rms of relative changes). The remaining error
  /// is about a third of that. The ripple structure of large spheres takes some 10 nodes per unit of 2 pi
  /// radius n/lambda, most of all in backscattering.
  double averaging = 1e-3, phase_averaging = 1e-2;
  std::size_t most_radii = 16384;  ///< per population and wavelength; beyond, `converged` is false
  PhaseAccuracy phase;
};

/// Coefficients at one wavelength, 1/m.
struct EnsembleCoefficients {
  double lambda_nm = 0;
  double absorption = 0, scattering = 0;
  double asymmetry = 0;               ///< 0 if nothing is scattered
  double independent_scattering = 0;  ///< `scattering` without structure factors
  double independent_asymmetry = 0;   ///< `asymmetry` without structure factors
  std::size_t radii = 0;              ///< number of nodes in use
  bool converged = true;              ///< whether the averages over radii have the requested accuracy

  double extinction() const { return absorption + scattering; }
  double albedo() const { return extinction() > 0 ? scattering / extinction() : 1; }
};

/// A callback that receives the estimated progress of a computation, which never decreases from 0 to 1. It is
/// called concurrently from the threads of a `ParallelFor`; an exception that it throws ends the computation.
using TellProgress = std::function<void(double part)>;

class Ensemble {
public:
  /// `host` is the real index of the medium around the particles. Computes the averages over radii at each of
  /// `lambda_nm`. For a single population with number density 1, coefficients are mean cross sections. Throws
  /// std::domain_error if a wavelength, an index or a number density is not positive, or if hard spheres do
  /// not fit.
  Ensemble(std::vector<ParticlePopulation> populations, std::vector<double> lambda_nm,
           const SpectralFunction& host, const EnsembleAccuracy& accuracy = {},
           const ParallelFor& parallel_for = serial_for);

  const std::vector<EnsembleCoefficients>& coefficients() const { return coefficients_; }

  /// Returns the scattering coefficient per solid angle, 1/(m sr), at one of the wavelengths.
  std::vector<double> differential(std::size_t wavelength, std::span<const double> mu) const;

  /// Returns the phase functions at all wavelengths on one grid of angles. Throws std::domain_error if
  /// nothing is scattered at one of them.
  PhaseTables phases(const ParallelFor& parallel_for = serial_for,
                     const TellProgress& progress = nullptr) const;

private:
  struct Average;
  void refine(std::vector<Average>& averages, const ParallelFor& parallel_for);
  void correlate(std::vector<Average>& averages, const ParallelFor& parallel_for);

  std::vector<ParticlePopulation> populations_;
  std::vector<double> lambda_nm_, host_;
  EnsembleAccuracy accuracy_;
  std::vector<EnsembleCoefficients> coefficients_;
  std::vector<std::vector<RadiusNode>> nodes_;  ///< of populations within wavelengths; weights are per m^3
};

/// Factors by which the interference of hard spheres changes a population's scattering coefficient and its
/// reduced one, sigma_s (1 - g). They are neglected if `hard_spheres` is off.
struct DependentScattering {
  double scattering = 1, reduced = 1;
};
DependentScattering dependent_scattering(const ParticlePopulation& population, double lambda_nm, double host,
                                         const EnsembleAccuracy& accuracy = {},
                                         const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::optics
