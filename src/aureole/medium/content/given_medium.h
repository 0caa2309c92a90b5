// SPDX-License-Identifier: Apache-2.0
// `GivenMedium`: a medium whose scattering and absorption coefficients are given directly.
#pragma once

#include <optional>
#include <vector>

#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {

class GivenMedium : public Medium {
public:
  /// Reads sigma_t and albedo, or sigma_a and sigma_s; then scale, emission, temperature, index of refraction
  /// and phase function. Throws located Errors.
  explicit GivenMedium(const Properties& properties);
  /// Returns the documentation of these parameters.
  static std::vector<ParameterDoc> rows();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const final;
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const final;
  Majorants majorants() const final { return grid_ ? Majorants(*grid_) : Majorants(); }
  const PhaseFunction& phase() const final { return *phase_; }
  bool emits() const final { return emission_ || temperature_; }
  bool scatters() const final;
  bool is_uniform() const final;
  bool has_uniform_emission() const final;
  float sampling_weight() const final { return sampling_weight_; }

private:
  VolumePtr extinction_, albedo_;  ///< volumes of sigma_t and albedo; null if sigma_a and sigma_s are given
  /// constant absorption and scattering coefficients; null if sigma_t and albedo are given
  VolumePtr absorption_, scattering_;
  VolumePtr emission_;     ///< volume of emitted radiance; null: no given emission
  VolumePtr temperature_;  ///< temperature [K]; null: no thermal emission
  float scale_ = 1, index2_ = 1, sampling_weight_ = 1;
  PhaseFunctionPtr phase_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole
