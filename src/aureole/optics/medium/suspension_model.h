// SPDX-License-Identifier: Apache-2.0
// Media by their composition: a liquid or gas and suspended particles, each kind with a material, sizes and
// an amount.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/optics/medium/solution_model.h"
#include "aureole/optics/particle/ensemble.h"

namespace aureole::optics {

/// The amount of one kind of particles, relative to the whole medium including all particles.
struct Amount {
  enum class Kind {
    number,  ///< number of particles per m^3
    volume,  ///< fraction of the volume
    mass     ///< fraction of the mass; needs densities
  };
  Kind kind = Kind::volume;
  double value = 0;
};

struct Ingredient {
  std::string name;  ///< name of the ingredient in messages
  std::shared_ptr<const ParticleKind> particles;
  RadiusDistribution radii;
  Amount amount;
  double density = 0;  ///< density of the particles' material [kg/m^3]; 0: unknown
  /// Whether positions are correlated as hard spheres (see `ParticlePopulation`).
  bool hard_spheres = false;
  DataRange data = {};  ///< wavelengths over which the index of the particles was measured
};

/// Coefficients and phase functions of a medium over wavelengths.
struct MediumSpectrum {
  /// Coefficients of host and particles together, at increasing wavelengths.
  std::vector<EnsembleCoefficients> coefficients;
  /// Phase functions at the same wavelengths; no tables if nothing scatters or none were requested.
  PhaseTables phases;
};

class Suspension {
public:
  /// Throws std::domain_error, with the ingredient's name, if an amount is negative, a density is missing, or
  /// the particles do not fit: the limit is the closest packing of spheres, or `kMaxHardSphereFraction` with
  /// `hard_spheres`.
  Suspension(ClearMedium host, std::vector<Ingredient> ingredients);

  const ClearMedium& host() const { return host_; }
  const std::vector<Ingredient>& ingredients() const { return ingredients_; }
  /// Returns the number of particles of an ingredient per m^3.
  double number_density(std::size_t ingredient) const { return populations_[ingredient].number_density; }
  double volume_fraction(std::size_t ingredient) const { return populations_[ingredient].volume_fraction(); }
  double volume_fraction() const;  ///< Returns the volume fraction of all particles.
  /// Returns the density in kg/m^3; 0 if the density of a component is unknown.
  double density() const;
  /// Returns the real index of the host; the particles' contribution to refraction is neglected.
  double index(double lambda_nm) const { return host_.index(lambda_nm); }

  /// Estimates the absorption coefficient of the particles, 1/m, without their diffraction and refraction
  /// (`ParticleKind::straight_absorption` at the effective radius).
  double straight_absorption(double lambda_nm) const;

  /// Computes the spectrum at increasing wavelengths in nm. sigma_a of the host is scaled by its volume
  /// fraction.
  MediumSpectrum spectrum(const std::vector<double>& lambda_nm, bool with_phases = true,
                          const EnsembleAccuracy& accuracy = {}, const ParallelFor& parallel_for = serial_for,
                          const TellProgress& progress = nullptr) const;

  /// Returns the effect of the option `hard_spheres` of an ingredient at a wavelength, whether it is on or
  /// not. Callers warn if it is off and scattering would change by more than 1 %. Returns nothing if the
  /// particles fill more than `kMaxHardSphereFraction`.
  std::optional<DependentScattering> dependence(std::size_t ingredient, double lambda_nm,
                                                const EnsembleAccuracy& accuracy = {},
                                                const ParallelFor& parallel_for = serial_for) const;

private:
  ClearMedium host_;
  std::vector<Ingredient> ingredients_;
  std::vector<ParticlePopulation> populations_;
};

}  // namespace aureole::optics
