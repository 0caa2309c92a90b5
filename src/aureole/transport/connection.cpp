// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/connection.h"

namespace aureole {

namespace {

/// The fraction of light that passes straight through a surface along `d`, in either direction.
Spectrum null_transmittance(const SurfacePoint& point, const Vec3& d, const Wavelengths& w) {
  if (!point.surface->passable) return 0.f;
  return point.surface->bsdf->null_transmittance(point.shading.to_local(-d), BsdfContext{w, point});
}

}  // namespace

bool is_lost(const Scene& scene, Connection& c) {
  if (scene.tracer().is_traceable(c.flight.ray)) return false;
  c.lose();
  return true;
}

void travel(Connection& c, float t, const Wavelengths& w, Glow* glow) {
  const float unit = length(c.flight.ray.d);  // of the ray's distances
  c.key = c.key * 0x9e3779b9u + 1;            // each medium on the way has numbers of its own
  const Straight s = transmittance(*c.flight.medium, {c.flight.ray.o, c.d}, t * unit, w, c.key, glow);
  c.passed_before = c.passed;
  c.passed *= s.passed;
  c.light *= s.roulette;
}

Event cross(const SurfacePoint& point, Connection& c, const Wavelengths& w) {
  if (!(c.through_emitters && point.surface->light) && !c.flight.is_hidden(*point.surface)) {
    c.light *= null_transmittance(point, c.d, w);
    if (is_black(c.light)) return Event::blocked;
  }
  c.flight.pass(point, c.d, c.d);
  c.flight.ray.o = offset_origin(point, c.d);
  if (c.infinite) {
    c.flight.ray.t_max = kInfinity;
    return Event::crossed;
  }
  c.flight.ray.d = c.target - c.flight.ray.o;
  // The march ends beyond a surface that the target lies on: going back would hit that surface again and
  // again. So would a segment within the plane of a surface, whose ends are moved to different sides of it.
  const bool turned = dot(c.flight.ray.d, point.ng) * dot(c.d, point.ng) < 0;
  return dot(c.flight.ray.d, c.d) > 0 && !turned ? Event::crossed : Event::escape;
}

bool connect(const Scene& scene, Connection& c, const Wavelengths& w) {
  if (scene.has_binary_visibility() && !c.through_emitters) {
    if (!scene.tracer().occluded(c.flight.ray)) return true;
    return is_lost(scene, c);
  }
  for (;;) {
    const Event event = cross(scene, scene.tracer().intersect(c.flight.ray), c, w);
    if (event != Event::crossed) return event == Event::escape;
  }
}

}  // namespace aureole
