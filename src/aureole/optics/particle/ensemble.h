// SPDX-License-Identifier: Apache-2.0
// Scattering and absorption by many particles of several kinds and sizes, over wavelengths: coefficients and
// phase functions. The sum over particles is one of intensities; of particles so dense that their positions
// are not independent, of intensities times a structure factor.
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

/// Particles of one kind and many sizes, and how many there are.
struct ParticlePopulation {
  std::shared_ptr<const ParticleKind> kind;
  RadiusDistribution radii;
  double number_density = 1;  ///< per m^3

  /// Volume of the particles in a volume of the whole.
  double volume_fraction() const { return number_density * radii.mean_volume(); }

  /// Whether the particles keep their distance as hard spheres of their own volume fraction. Each size is
  /// multiplied by the structure factor of equal spheres of that size (the local monodisperse approximation;
  /// Pedersen, J. Appl. Cryst. 27 (1994) 595). Populations do not correlate with one another.
  bool hard_spheres = false;
};

struct EnsembleAccuracy {
  /// Radii are doubled in number until cross sections and asymmetry change by at most `averaging`, and the
  /// phase function at 28 angles by at most `phase_averaging` (rms of what is relative to the local value;
  /// what remains is about a third of that). The ripple of large spheres takes some 10 nodes per unit of 2 pi
  /// radius n/lambda, most of all for what they scatter straight back.
  double averaging = 1e-3, phase_averaging = 1e-2;
  std::size_t most_radii = 16384;  ///< per population and wavelength; beyond, `converged` is false
  PhaseAccuracy phase;
};

/// Coefficients at one wavelength, 1/m.
struct EnsembleCoefficients {
  double lambda_nm = 0;
  double absorption = 0, scattering = 0;
  double asymmetry = 0;               ///< 0 where nothing is scattered
  double independent_scattering = 0;  ///< what `scattering` would be without structure factors
  double independent_asymmetry = 0;   ///< likewise
  std::size_t radii = 0;              ///< nodes in use
  bool converged = true;              ///< whether the averages over radii are as accurate as asked

  double extinction() const { return absorption + scattering; }
  double albedo() const { return extinction() > 0 ? scattering / extinction() : 1; }
};

/// Told which part of a computation, 0 to 1, is done: an estimate, which does not fall. Called from the threads of
/// its `ParallelFor`, several at once; what it throws ends the computation.
using TellProgress = std::function<void(double part)>;

class Ensemble {
public:
  /// `host`: real index of the medium around the particles. Averages over radii are found here, at each of
  /// `lambda_nm`. Of a single population with number density 1, coefficients are mean cross sections. Throws
  /// std::domain_error where a wavelength, an index or a number density is not positive, and where hard
  /// spheres do not fit.
  Ensemble(std::vector<ParticlePopulation> populations, std::vector<double> lambda_nm,
           const SpectralFunction& host, const EnsembleAccuracy& accuracy = {},
           const ParallelFor& parallel_for = serial_for);

  const std::vector<EnsembleCoefficients>& coefficients() const { return coefficients_; }

  /// Scattering coefficient per solid angle, 1/(m sr), of one of the wavelengths.
  std::vector<double> differential(std::size_t wavelength, std::span<const double> mu) const;

  /// Phase functions of all wavelengths on one grid of angles. Throws std::domain_error where nothing is
  /// scattered at one of them.
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

/// By which factor the interference of hard spheres changes the scattering coefficient of a population, and
/// the reduced one, sigma_s (1 - g): what is lost where `hard_spheres` is off.
struct DependentScattering {
  double scattering = 1, reduced = 1;
};
DependentScattering dependent_scattering(const ParticlePopulation& population, double lambda_nm, double host,
                                         const EnsembleAccuracy& accuracy = {},
                                         const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::optics
