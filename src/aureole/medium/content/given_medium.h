// SPDX-License-Identifier: Apache-2.0
// `GivenMedium`: a medium whose coefficients are given, not what is in it.
#pragma once

#include <optional>
#include <vector>

#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {

class GivenMedium : public Medium {
public:
  /// Reads sigma_t and albedo, or sigma_a and sigma_s; scale, emission, temperature and index, and the phase
  /// function. Throws located Errors.
  explicit GivenMedium(const Properties& properties);
  /// The rows of their table.
  static std::vector<ParameterDoc> rows();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const final;
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const final;
  Majorants majorants() const final { return grid_ ? Majorants(*grid_) : Majorants(); }
  const PhaseFunction& phase() const final { return *phase_; }
  bool emits() const final { return emission_ || temperature_; }
  bool is_uniform() const final;
  bool has_uniform_emission() const final;
  float sampling_weight() const final { return sampling_weight_; }

private:
  VolumePtr extinction_, albedo_;      ///< or
  VolumePtr absorption_, scattering_;  ///< these, which are constant
  VolumePtr emission_;                 ///< or null
  VolumePtr temperature_;              ///< [K], or null
  float scale_ = 1, index2_ = 1, sampling_weight_ = 1;
  PhaseFunctionPtr phase_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole
