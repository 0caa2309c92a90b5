// SPDX-License-Identifier: Apache-2.0
// `SplatMedium`: a cloud of Gaussian splats or points in the scene. The integrator `splat` projects and blends its splats;
// the others follow light in it as in any medium, whose extinction is the sum of the splats' Gaussians.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "aureole/math/transform.h"
#include "aureole/medium/medium.h"
#include "aureole/medium/splats/splat_field.h"
#include "aureole/medium/transport_notes.h"
#include "aureole/parameter/splat/splat_cloud.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class SplatMedium final : public Medium, public TransportNotes {
public:
  explicit SplatMedium(const Properties& properties);
  static std::vector<ParameterDoc> rows();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const override;
  const PhaseFunction& phase() const override { return *phase_; }
  Majorants majorants() const override { return Majorants(field().grid()); }
  Spectrum majorant(const Vec3&, const Wavelengths&) const override { return 1.f; }
  bool has_closed_form() const override { return !color_emits_; }
  double optical_thickness(const Ray& ray, float t_max) const override {
    return field().optical_thickness(ray, t_max);
  }
  float distance_of_thickness(const Ray& ray, float t_max, double wanted) const override {
    return field().distance_of_thickness(ray, t_max, wanted);
  }
  std::vector<std::string> transport_notes() const override;
  bool is_uniform() const override { return false; }
  bool has_uniform_emission() const override { return false; }
  bool emits() const override { return color_emits_; }
  bool emits_by_direction() const override { return color_emits_ && cloud_->degree > 0; }
  bool scatters() const override { return !color_emits_; }
  float sampling_weight() const override { return sampling_weight_; }

  const SplatCloud& cloud() const { return *cloud_; }
  /// Transform from the axes of the cloud to the world.
  const Transform& to_world() const { return to_world_; }
  float emission_scale() const { return emission_scale_; }
  /// The splats as a field of extinction, made when it is first needed.
  const SplatField& field() const;

private:
  std::shared_ptr<const SplatCloud> cloud_;
  Transform to_world_;
  bool color_emits_;
  SplatField::Options field_options_;
  float emission_scale_, sampling_weight_;
  SampledSpectrum d65_;
  PhaseFunctionPtr phase_;
  mutable std::once_flag field_made_;
  mutable std::unique_ptr<const SplatField> field_;
};

}  // namespace aureole
