// SPDX-License-Identifier: Apache-2.0
// Places in a medium along a flight that are chosen by a light near it, beside the place where the flight is
// scattered. Both ways of choosing a place know the pivot of the other, a point of a light that is chosen for
// the flight as a whole; what is connected from the place does not depend on it. So the balance heuristic
// compares the two densities along the flight (docs/decisions/0065-equiangular-sampling.md).
#pragma once

#include <optional>

#include "aureole/transport/endpoints.h"
#include "aureole/transport/equiangular.h"

namespace aureole {

/// Places along the flight, of length t_max, about a light near it; nothing where the flight's own choice is as
/// good: where media absorb most of the light before it gets there, or beyond the nearest place. `u` chooses
/// among lights.
inline std::optional<Equiangular> places_by_light(const Scene& scene, const Flight& flight, float t_max,
                                                  const Wavelengths& w, float u) {
  const LightTree& tree = scene.lights().tree();
  const auto leaf = tree.choose_along(flight.ray, t_max, u);
  if (!leaf) return {};
  const Bounds3& box = tree.leaf(*leaf).box;
  const Equiangular places(flight.ray, t_max, box.center(), 0.5f * length(box.diagonal()));
  constexpr float kNear = 1, kReach = 4;  // optical depths, by measurement (docs/decisions/0065-*.md)
  const MajorantGrid* grid = flight.medium->majorants();
  const float sigma = mean(flight.medium->majorant(flight.ray.d, w)) * (grid ? grid->maximum() : 1.f);
  if (!places.is_valid() || !(sigma * places.distance() < kNear) || !(sigma * places.nearest() < kReach))
    return {};
  return places;
}

/// Chooses such a place, by `u`, at the end of `path` and connects it with a light, as `connect_to_light` does.
inline bool connect_along(const Scene& scene, const Flight& flight, PathDensity path,
                          const Equiangular& places, float u, float u1, Vec2 u2, const Wavelengths& w,
                          std::uint32_t key, Connection& out) {
  const Medium& medium = *flight.medium;
  const float t = places.sample(u);
  const Vec3 p = flight.ray.o + flight.ray.d * t;
  MediumCoefficients at;
  medium.eval(p, flight.ray.d, w, at);
  if (is_black(at.sigma_s)) return false;
  const Spectrum passed = passed_to(medium, flight.ray, t, w, key);
  const Spectrum by_light = path.ratio * places.pdf(t);
  path.pass({Weight(passed * at.sigma_s), passed * at.sigma_t, 1.f});
  const Vertex vertex({p, &medium}, -flight.ray.d, w);
  return connect_to_light(scene, vertex, flight, path, u1, u2, w, {}, key + 1, out, &by_light);
}

}  // namespace aureole
