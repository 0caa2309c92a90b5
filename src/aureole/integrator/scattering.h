// SPDX-License-Identifier: Apache-2.0
// What every integrator does at a surface: scatter and connect to lights in world space, with the checks that
// keep light from leaking through a shading normal's wrong side. Integrators are built from these functions;
// none names a concrete plug-in.
#pragma once

#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/scene/scene.h"
#include "aureole/spectrum/path_density.h"

namespace aureole {

/// A surface point as a path sees it: the point, its BSDF and the direction towards the previous vertex.
class SurfaceVertex {
public:
  SurfaceVertex(const SurfacePoint& point, const Vec3& to_previous, const Wavelengths& w,
                std::uint32_t key = 0, TransportMode mode = TransportMode::radiance)
      : point_(&point),
        bsdf_(point.shape->bsdf().get()),
        lobes_(point.shape->lobes()),
        context_{w, point, mode, key},
        wi_(point.shading.to_local(to_previous)),
        wi_side_(dot(point.ng, to_previous)) {}

  const SurfacePoint& point() const { return *point_; }
  const Bsdf& bsdf() const { return *bsdf_; }
  /// The shading normal on the side that light may be scattered from; zero where that is both. Choosing
  /// lights and directions, and their densities, all depend on it.
  Vec3 facing_normal() const {
    return has(lobes_, Lobe::transmit) ? Vec3{} : wi_.z < 0 ? -point_->shading.n : point_->shading.n;
  }
  /// Next-event estimation is worth its ray.
  bool is_smooth() const { return has(lobes_, Lobe::diffuse | Lobe::glossy); }

  /// Value and density for a world direction; zero where shading and geometric normal disagree about its
  /// side.
  BsdfEval eval_pdf(const Vec3& world_wo) const {
    const Vec3 wo = point_->shading.to_local(world_wo);
    if (!consistent(wo, world_wo)) return {};
    return bsdf_->eval_pdf(wi_, wo, context_);
  }
  /// A sampled direction in world space.
  std::optional<BsdfSample> sample(float u1, Vec2 u2) const {
    std::optional<BsdfSample> s = bsdf_->sample(wi_, u1, u2, context_);
    if (!s) return s;
    const Vec3 world = point_->shading.to_world(s->wo);
    if (s->pdf[0] > 0 && consistent(s->wo, world))
      s->wo = normalize(world);
    else
      s.reset();
    return s;
  }

  /// What a light path (importance mode) multiplies a value by, so that it finds what a path from the sensor
  /// finds where the shading normal differs from the geometric one (Veach 1997, section 5.3.2): the value
  /// holds the cosine with the shading normal of the direction that light leaves to, and belongs with that of
  /// the direction it comes from, while light leaves and arrives by the geometric normal.
  float adjoint_correction(const Vec3& world_wo) const {
    const float below = std::abs(wi_side_ * dot(point_->shading.n, world_wo));
    return below > 0 ? std::abs(wi_.z * dot(point_->ng, world_wo)) / below : 0.f;
  }

private:
  /// Reflection (in the shading frame) must stay on the geometric side it came from, transmission must change
  /// it.
  bool consistent(const Vec3& wo, const Vec3& world_wo) const {
    return (wi_.z * wo.z > 0) == (wi_side_ * dot(point_->ng, world_wo) > 0);
  }

  const SurfacePoint* point_;
  const Bsdf* bsdf_;
  Lobe lobes_;
  BsdfContext context_;
  Vec3 wi_;
  float wi_side_;
};

/// A light chosen for a vertex, and the density with which its direction was chosen.
struct LightConnection {
  const DirectSample& direct;
  const BsdfEval& scattering;  ///< of the vertex for that direction
  float density;               ///< selection probability times density, or mass for a delta light
};

/// Chooses a light and a direction towards it for the vertex and calls `use(LightConnection)`; does not where
/// it could carry no light. (A call-back: the record is large, and every copy of it shows.)
template <class Use>
inline void sample_light(const Scene& scene, const SurfaceVertex& vertex, float u1, Vec2 u2,
                         const Wavelengths& w, Use&& use) {
  const Vec3 facing = vertex.facing_normal();
  const auto choice = scene.lights().choose(vertex.point().p, facing, u1);
  if (!choice || !(choice->probability > 0)) return;
  const auto direct = choice->emitter->sample_direct_facing(vertex.point().p, facing, choice->part, u2, w);
  if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) return;
  const BsdfEval scattering = vertex.eval_pdf(direct->wo);
  if (is_black(scattering.value)) return;
  use(LightConnection{*direct, scattering, choice->probability * direct->pdf});
}

/// Density with which `sample_light` at `from` would have chosen the emitting surface point (or, `hit` null,
/// the escaping direction `d` of an infinite emitter); `facing` is the vertex's facing_normal().
inline float light_density(const Scene& scene, const Vec3& from, const Vec3& facing, const Emitter& emitter,
                           const SurfacePoint* hit, const Vec3& d) {
  if (!hit)
    return scene.lights().probability(from, facing, &emitter, 0) *
           emitter.pdf_direct_escaped(from, facing, d);
  return scene.lights().probability(from, facing, &emitter, emitter.part_of(*hit)) *
         emitter.pdf_direct(from, *hit);
}

}  // namespace aureole
