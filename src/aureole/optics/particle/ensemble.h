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
  double number_density = 1;  ///< number of particles per m^3

  /// Returns the fraction of the total volume that the particles fill.
  double volume_fraction() const { return number_density * radii.mean_volume(); }

  /// Whether positions are those of hard spheres of the population's own volume fraction. Each size is
  /// multiplied by the structure factor of equal spheres of that size (local monodisperse approximation;
  /// Pedersen, J. Appl. Cryst. 27 (1994) 595). Different populations are uncorrelated.
  bool hard_spheres = false;
};

struct EnsembleAccuracy {
  /// The number of radii is doubled until scattering, extinction, asymmetry and absorption change by at most
  /// `averaging`. One or two nodes per unit of 2 pi radius n/lambda suffice for scattering. The resonances in
  /// which a weak absorber absorbs are narrower by far: each is averaged in closed form
  /// (`Particle::mean_absorption`). Absorption below the part `least_absorption` of the extinction may change by
  /// `averaging` times that part.
  double averaging = 1e-3, least_absorption = 1e-6;
  /// Bound of the change of the phase function at `Ensemble::probes`: root mean square of the relative changes.
  /// The remaining error is about a third of it.
  double phase_averaging = 1e-2;
  /// Upper bounds of the number of radii per population and wavelength, for phase functions and for
  /// coefficients. Where the bound for coefficients is reached, `converged` is false. With
  /// `most_coefficient_radii` at 0 the coefficients are those of the radii of the phase function.
  std::size_t most_radii = 16384, most_coefficient_radii = 16384;
  PhaseAccuracy phase;
};

/// Coefficients at one wavelength, 1/m.
struct EnsembleCoefficients {
  double lambda_nm = 0;
  double absorption = 0, scattering = 0;
  double asymmetry = 0;               ///< mean cosine of the scattering angle; 0 if nothing is scattered
  double independent_scattering = 0;  ///< `scattering` without structure factors
  double independent_asymmetry = 0;   ///< `asymmetry` without structure factors
  std::size_t radii = 0;              ///< number of radii of the phase function
  std::size_t coefficient_radii = 0;  ///< number of radii of the coefficients
  bool converged = true;              ///< whether the coefficients have the requested accuracy
  bool phase_converged = true;        ///< whether the phase function has the requested accuracy
  /// Phase function at `Ensemble::probes`, 1/sr, without structure factors; empty if nothing is scattered.
  std::vector<double> phase = {};
  /// Estimated errors of the averages over radii: the changes by the last increase of their number; 0 for
  /// spheres of one size.
  double absorption_error = 0, scattering_error = 0;
  std::vector<double> phase_error = {};

  double extinction() const { return absorption + scattering; }
  double albedo() const { return extinction() > 0 ? scattering / extinction() : 1; }
};

/// A callback that receives the estimated progress of a computation, which never decreases from 0 to 1. It is
/// called concurrently from the threads of a `ParallelFor`; an exception that it throws ends the computation.
using TellProgress = std::function<void(double part)>;

class Ensemble {
public:
  /// Computes the averages over radii; `host` is the real index of the medium around the particles. The
  /// averages are taken over radii at each of `lambda_nm`. For a single population with number density 1,
  /// coefficients are mean cross sections. Throws std::domain_error if a wavelength, an index or a number
  /// density is not positive, or if hard spheres do not fit.
  Ensemble(std::vector<ParticlePopulation> populations, std::vector<double> lambda_nm,
           const SpectralFunction& host, const EnsembleAccuracy& accuracy = {},
           const ParallelFor& parallel_for = serial_for);

  const std::vector<EnsembleCoefficients>& coefficients() const { return coefficients_; }

  /// Returns the cosines of the scattering angles at which averages of phase functions are compared, from 0 to
  /// 180 degrees.
  static std::vector<double> probes();

  /// Returns the scattering coefficient per solid angle, 1/(m sr), at one of the wavelengths.
  std::vector<double> differential(std::size_t wavelength, std::span<const double> mu) const;

  /// Returns the phase functions at all wavelengths on one grid of angles. Throws std::domain_error if
  /// nothing is scattered at one of them.
  PhaseTables phases(const ParallelFor& parallel_for = serial_for,
                     const TellProgress& progress = nullptr) const;

private:
  struct Average;
  std::vector<Average> sum_over(std::span<const std::vector<RadiusNode>> nodes, std::span<const double> mu,
                                const ParallelFor& parallel_for) const;
  std::vector<std::vector<RadiusNode>> next_nodes(std::vector<Average>& averages, double density,
                                                  std::size_t most) const;
  void refine_phases(std::vector<Average>& averages, const ParallelFor& parallel_for) const;
  void refine_coefficients(std::vector<Average>& averages, const ParallelFor& parallel_for) const;
  void correlate(std::vector<Average>& averages, const ParallelFor& parallel_for) const;

  std::vector<ParticlePopulation> populations_;
  std::vector<double> lambda_nm_, host_;
  EnsembleAccuracy accuracy_;
  std::vector<EnsembleCoefficients> coefficients_;
  /// nodes of the populations for each wavelength; weights are per m^3
  std::vector<std::vector<RadiusNode>> nodes_;
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
