// SPDX-License-Identifier: Apache-2.0
// `Mixture`: a medium whose coefficients and phase function are computed from its ingredients.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/ingredient/ingredient.h"
#include "aureole/medium/medium.h"
#include "aureole/optics/medium/suspension_model.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {

class Mixture : public Medium {
public:
  /// Tabulates `content`, whose coefficients are in 1/m, over the wavelengths of the scene and in its unit of
  /// length. Reads the volume "density".
  Mixture(const Properties& properties, const optics::Suspension& content);
  static ParameterDoc density_row();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const final;
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const final;
  Majorants majorants() const final { return grid_ ? Majorants(*grid_) : Majorants(); }
  const PhaseFunction& phase() const final { return *phase_; }
  bool is_uniform() const final { return !grid_; }
  bool has_uniform_emission() const final { return true; }
  bool emits() const final { return false; }
  bool scatters() const final { return scattering_.maximum() > 0; }

private:
  std::shared_ptr<const void> tables_;       ///< keeps the tables alive, so that equal mixtures share them
  SampledSpectrum extinction_, scattering_;  ///< coefficients at density 1 [1/length]
  PhaseFunctionPtr phase_;
  VolumePtr density_;  ///< factor of the coefficients; null: density 1 everywhere
  std::optional<MajorantGrid> grid_;
};

/// Returns the liquid or gas that the parameter `name` gives: "water", "air", "vacuum", a dielectric or an
/// index of refraction. The default is water. Reads "dispersion".
optics::ClearMedium read_clear_medium(const Properties& properties, std::string_view name);

/// Returns the children of the family "ingredient".
std::vector<IngredientPtr> read_ingredients(const Properties& properties);

/// Returns `base` with `ingredients` added: particles beside those of `base`, dyes dissolved in its host. An
/// error caused by one ingredient alone is located at it, an error of their combination at the medium.
optics::Suspension mix(const Properties& properties, const optics::Suspension& base,
                       const std::vector<IngredientPtr>& ingredients, bool dependent_scattering);

}  // namespace aureole
