// SPDX-License-Identifier: Apache-2.0
// `Mixture`: a medium whose coefficients and phase function follow from what is in it.
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

private:
  std::shared_ptr<const void> tables_;       ///< kept for equal mixtures
  SampledSpectrum extinction_, scattering_;  ///< [1/length]
  PhaseFunctionPtr phase_;
  VolumePtr density_;  ///< or null: 1
  std::optional<MajorantGrid> grid_;
};

/// The liquid or gas that `name` gives: "water", "air", "vacuum", a dielectric or a refractive index; water
/// where absent. Reads "dispersion".
optics::ClearMedium read_clear_medium(const Properties& properties, std::string_view name);

/// The children of the family "ingredient".
std::vector<IngredientPtr> read_ingredients(const Properties& properties);

/// The suspension of all of `ingredients`, beside those that `base` has, with their dyes dissolved in its host.
/// An error in one of them alone is located there, an error in all of them together at the medium.
optics::Suspension mix(const Properties& properties, const optics::Suspension& base,
                       const std::vector<IngredientPtr>& ingredients, bool dependent_scattering);

}  // namespace aureole
