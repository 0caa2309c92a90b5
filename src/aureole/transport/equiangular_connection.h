// SPDX-License-Identifier: Apache-2.0
// Equiangular sampling as a second technique of a segment in a medium: positions along it are sampled about a
// light near it, beside the position where distance sampling scatters the path. Both techniques know the
// pivot of the other, a point of a light that is chosen for the segment as a whole; the connection from the
// position does not depend on the pivot. So the balance heuristic compares the two pdfs along the segment
// (docs/decisions/0065-equiangular-sampling.md).
#pragma once

#include <optional>

#include "aureole/transport/equiangular.h"
#include "aureole/transport/next_event.h"

namespace aureole {

/// Equiangular sampling along the ray up to t_max about a light near it. Nothing where distance sampling is
/// as good: where media absorb most of the light before it gets there, or beyond the point of the ray nearest
/// to the light. `u` chooses among lights.
inline std::optional<Equiangular> equiangular_positions(const Scene& scene, const RayState& state,
                                                        float t_max, const Wavelengths& w, float u) {
  const Ray ray = state.from_surface();
  const EmissionBounds* light = scene.lights().choose_along(ray, t_max, u, w.time);
  if (!light) return {};
  const Bounds3& box = light->box;
  const Equiangular positions(ray, t_max + state.offset, box.center(), 0.5f * length(box.diagonal()));
  // Largest optical depths, by measurement (docs/decisions/0065-equiangular-sampling.md): of the distance of the
  // light from the ray, and along the ray to the point nearest to the light.
  constexpr float kNear = 1, kReach = 4;
  const float sigma = mean(state.medium->majorant(state.ray.d, w)) * state.medium->majorants().max_bound();
  if (!positions.is_valid() || !(sigma * positions.distance() < kNear) ||
      !(sigma * positions.nearest() < kReach))
    return {};
  return positions;
}

/// Samples an equiangular position, by `u`, on the segment at the end of `path` and connects it with a light,
/// as `connect_to_light` does.
template <class L>
bool connect_along(const Scene& scene, const RayState& state, BasicPathDensity<L, PathStart::sensor> path,
                   const Equiangular& positions, float u, float u1, Vec2 u2, const Wavelengths& w,
                   std::uint32_t key, BasicConnection<L>& out) {
  const Medium& medium = *state.medium;
  const float t = positions.sample(u);
  const Ray ray = state.from_surface();
  const Vec3 p = ray.o + ray.d * t;
  MediumCoefficients at;
  medium.eval(p, state.ray.d, w, at);
  if (is_black(at.sigma_s)) return false;
  const Spectrum passed = transmittance_to(medium, ray, t, w, key);
  const Spectrum r_equiangular = path.r_u * positions.pdf(t);
  path.pass({passed * at.sigma_s, passed * at.sigma_t, 1.f});
  const BasicVertex<Space::any, L> vertex({p, &medium}, -state.ray.d, w, TransportMode::radiance);
  return connect_to_light(scene, vertex, sample_light(scene, vertex.p(), vertex.facing(), u1, u2, w), state,
                          path, w, {}, key + 1, out, &r_equiangular);
}

}  // namespace aureole
