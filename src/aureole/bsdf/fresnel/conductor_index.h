// SPDX-License-Identifier: Apache-2.0
// The complex index of refraction of a metal, read from a BSDF's parameters.
#pragma once

#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {

/// The complex index of a conductor, read from `material` or from `eta` and `k`.
class ConductorIndex {
public:
  /// Reads `material` (default none: a perfect mirror), or `eta` and `k` (defaults 0 and 1). Errors are
  /// located.
  static ConductorIndex from(const Properties& properties);

  /// Returns the Fresnel reflectance for light from vacuum, cos_i in (0, 1].
  Spectrum reflectance(float cos_i, const BsdfContext& ctx) const;
  /// Returns the amplitudes of reflection for light from vacuum, cos_i in [0, 1].
  MirrorReflection::Amplitudes amplitudes(float cos_i, const BsdfContext& ctx) const;
  /// Returns the reflectance for diffuse light: the integral of 2 F(mu) mu over mu in [0, 1].
  Spectrum diffuse_reflectance(const BsdfContext& ctx) const;

private:
  void tabulate_diffuse();

  bool tabulated_ = false;
  SampledSpectrum eta_, k_, diffuse_;   // spectra of a named or constant material
  TexturePtr eta_texture_, k_texture_;  // textures, if an index varies over the surface
};

/// Returns the documentation of the parameters that conductors share: material, eta, k and
/// specular_reflectance, followed by `own`.
std::vector<ParameterDoc> conductor_parameters(std::vector<ParameterDoc> own = {});

}  // namespace aureole
