// SPDX-License-Identifier: Apache-2.0
// Media by what is in them: a liquid or gas, and the particles that float in it, each by material, sizes and
// amount.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/optics/medium/solution_model.h"
#include "aureole/optics/particle/ensemble.h"

namespace aureole::optics {

/// How much there is of one kind of particles, in the whole of the medium and all particles.
struct Amount {
  enum class Kind {
    number,  ///< per m^3
    volume,  ///< fraction of the volume
    mass     ///< fraction of the mass: needs densities
  };
  Kind kind = Kind::volume;
  double value = 0;
};

struct Ingredient {
  std::string name;  ///< for messages
  std::shared_ptr<const ParticleKind> particles;
  RadiusDistribution radii;
  Amount amount;
  double density = 0;  ///< of the particles' material, kg/m^3; 0: not known
  /// The option of `ParticlePopulation`: correct for positions that are not independent.
  bool hard_spheres = false;
};

/// Coefficients and phase functions over wavelengths.
struct MediumSpectrum {
  /// Host and particles together, at increasing wavelengths.
  std::vector<EnsembleCoefficients> coefficients;
  /// At the same wavelengths; no tables where nothing scatters, or none were asked for.
  PhaseTables phases;
};

class Suspension {
public:
  /// Throws std::domain_error, with the ingredient's name, where an amount is negative, a density is missing, or
  /// there is more than fits: the closest packing of spheres, or `kMaxHardSphereFraction` with `hard_spheres`.
  Suspension(ClearMedium host, std::vector<Ingredient> ingredients);

  const ClearMedium& host() const { return host_; }
  const std::vector<Ingredient>& ingredients() const { return ingredients_; }
  double number_density(std::size_t ingredient) const {
    return populations_[ingredient].number_density;
  }  ///< per m^3
  double volume_fraction(std::size_t ingredient) const { return populations_[ingredient].volume_fraction(); }
  double volume_fraction() const;  ///< of all particles
  /// kg/m^3; 0 where a density is not known.
  double density() const;
  /// Real index: that of the host (particles' share in the refraction of the whole is left out).
  double index(double lambda_nm) const { return host_.index(lambda_nm); }

  /// At each wavelength (nm, increasing) of a list. sigma_a of the host counts for the volume that is left to it.
  MediumSpectrum spectrum(const std::vector<double>& lambda_nm, bool with_phases = true,
                          const EnsembleAccuracy& accuracy = {}, const ParallelFor& parallel_for = serial_for,
                          const TellProgress& progress = nullptr) const;

  /// Effect of the option `hard_spheres` of an ingredient at a wavelength, whether it is on or not: worth a
  /// note where it is off and the scattering differs from 1 by more than 1 %. Nothing where the particles fill
  /// more than `kMaxHardSphereFraction`.
  std::optional<DependentScattering> dependence(std::size_t ingredient, double lambda_nm,
                                                const EnsembleAccuracy& accuracy = {},
                                                const ParallelFor& parallel_for = serial_for) const;

private:
  ClearMedium host_;
  std::vector<Ingredient> ingredients_;
  std::vector<ParticlePopulation> populations_;
};

}  // namespace aureole::optics
