// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/connection.h"

#include "aureole/transport/flight.h"

namespace aureole {

namespace {

/// The fraction of light that passes straight through a surface along `d`, in either direction.
Spectrum null_transmittance(const SurfacePoint& point, const Vec3& d, const Wavelengths& w) {
  if (!point.surface->passable) return 0.f;
  return point.surface->bsdf->null_transmittance(point.shading.to_local(-d), BsdfContext{w, point});
}

}  // namespace

void travel(Connection& c, float t, const Wavelengths& w) {
  const float unit = length(c.ray.d);  // of the ray's distances
  c.key = c.key * 0x9e3779b9u + 1;     // each medium on the way has numbers of its own
  c.passed *= transmittance(*c.medium, {c.ray.o, c.d}, t * unit, w, c.key);
}

Event cross(const SurfacePoint& point, Connection& c, const Wavelengths& w) {
  if (!(c.through_emitters && point.surface->light)) {
    c.light *= null_transmittance(point, c.d, w);
    if (is_black(c.light)) return Event::blocked;
  }
  c.medium = point.surface->medium_along(c.d, point.ng, c.medium);
  c.ray.o = offset_origin(point, c.d);
  if (c.infinite) {
    c.ray.t_max = kInfinity;
    return Event::crossed;
  }
  c.ray.d = c.target - c.ray.o;
  // The march ends beyond a surface that the target lies on: going back would hit that surface again and
  // again.
  return dot(c.ray.d, c.d) > 0 ? Event::crossed : Event::escape;
}

bool connect(const Scene& scene, Connection& c, const Wavelengths& w) {
  if (scene.has_binary_visibility() && !c.through_emitters) return !scene.tracer().occluded(c.ray);
  for (;;) {
    const Event event = cross(scene, scene.tracer().intersect(c.ray), c, w);
    if (event != Event::crossed) return event == Event::escape;
  }
}

}  // namespace aureole
