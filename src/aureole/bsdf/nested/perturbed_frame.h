// SPDX-License-Identifier: Apache-2.0
// `PerturbedFrame`: evaluates a nested BSDF in a perturbed shading frame, as bump and normal maps do.
#pragma once

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Directions below the horizon of either frame are black. With `flip_invalid_normals` a normal that faces
/// away from the viewer is mirrored at the shading normal (Schuessler, Heitz, Hanika & Dachsbacher 2017,
/// "Microfacet-based normal mapping for robust Monte Carlo path tracing"); the frame then depends on the
/// viewer. With `use_shadowing_function` light at grazing directions is attenuated (Estevez, Lecocq & Stein
/// 2019, "A microfacet-based shadowing function to solve the bump terminator problem", Ray Tracing Gems,
/// chapter 12).
///
/// The perturbed BSDF is not reciprocal. In importance mode the viewer is on the side of `wo`, and the value
/// is that of radiance mode with the directions exchanged, so that light and camera paths converge to one
/// picture (Veach 1997, section 5.3).
class PerturbedFrame : public Bsdf {
public:
  explicit PerturbedFrame(const Properties& properties);

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const final;
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const final;
  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const final;
  double single_scattering_loss(bool from_within) const final {
    return nested_->single_scattering_loss(from_within);
  }
  bool interior_index(const Wavelengths& w, Spectrum& n) const final { return nested_->interior_index(w, n); }
  bool exterior_index(const Wavelengths& w, Spectrum& n) const final { return nested_->exterior_index(w, n); }
  Lobe lobes() const final { return nested_->lobes(); }
  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const final {
    return nested_->diffuse_reflectance(wi, ctx);
  }
  Vec3 shading_normal(const SurfacePoint& point) const final { return unit_normal(point); }

protected:
  /// Returns the perturbed normal in local coordinates, finite, of any nonzero length.
  virtual Vec3 perturbed_normal(const SurfacePoint& point) const = 0;

private:
  class Turned;

  Vec3 unit_normal(const SurfacePoint& point) const;
  bool is_flipped(const Vec3& n, const Vec3& viewer) const;
  float probability_of_flipped(const Vec3& n, const Vec3& wi, TransportMode mode) const;
  float weight(const Vec3& n, const Vec3& wi, const Vec3& wi_t, const Vec3& wo, const Vec3& wo_t,
               TransportMode mode) const;

  BsdfPtr nested_;
  bool flip_invalid_normals_, use_shadowing_function_;
};

/// Returns the documentation of the parameters that all such BSDFs share.
std::vector<ParameterDoc> perturbed_frame_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
