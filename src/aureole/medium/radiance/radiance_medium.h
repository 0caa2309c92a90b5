// SPDX-License-Identifier: Apache-2.0
// `RadianceMedium`: a radiance grid in the scene. The integrator `radiance_field` composites it along rays; the others
// follow light through it as a medium that absorbs and emits by direction.
#pragma once

#include <memory>

#include "aureole/medium/medium.h"
#include "aureole/medium/radiance/grid_radiance.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

class RadianceMedium final : public Medium {
public:
  explicit RadianceMedium(const Properties& properties);

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const override;
  const PhaseFunction& phase() const override { return *phase_; }
  Majorants majorants() const override { return Majorants(field_->grid()); }
  Spectrum majorant(const Vec3& d, const Wavelengths&) const override { return field_->extinction_along(d); }
  bool is_uniform() const override { return false; }
  bool has_uniform_emission() const override { return false; }
  bool emits() const override { return true; }
  bool emits_by_direction() const override { return field_->voxels().degree > 0; }
  bool scatters() const override { return false; }
  float sampling_weight() const override { return sampling_weight_; }

  const RadianceField& field() const { return *field_; }
  /// Whether colours are encoded as sRGB.
  bool is_encoded() const { return is_encoded_; }
  float emission_scale() const { return emission_scale_; }

private:
  bool is_encoded_ = true;
  float emission_scale_, sampling_weight_;
  SampledSpectrum d65_;
  PhaseFunctionPtr phase_;
  std::unique_ptr<const RadianceField> field_;
};

}  // namespace aureole
