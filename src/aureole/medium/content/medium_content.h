// SPDX-License-Identifier: Apache-2.0
// `MediumContent`: the parameters that homogeneous and heterogeneous media share, read and evaluated.
#pragma once

#include <optional>
#include <vector>

#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {

class MediumContent {
public:
  /// Reads sigma_t and albedo, or sigma_a and sigma_s; scale, emission, temperature and index, and the phase
  /// function.
  /// Throws located Errors.
  explicit MediumContent(const Properties& properties);
  /// The rows of their table.
  static std::vector<ParameterDoc> rows();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const;
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const;
  /// Bounds of the extinction in cells, where it varies.
  const MajorantGrid* majorants() const { return grid_ ? &*grid_ : nullptr; }
  const PhaseFunction& phase() const { return *phase_; }
  bool emits() const { return emission_ || temperature_; }
  bool is_uniform() const;
  bool has_uniform_emission() const;

private:
  VolumePtr extinction_, albedo_;      ///< or
  VolumePtr absorption_, scattering_;  ///< these, which are constant
  VolumePtr emission_;                 ///< or null
  VolumePtr temperature_;              ///< [K], or null
  float scale_ = 1, index2_ = 1;
  PhaseFunctionPtr phase_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole
