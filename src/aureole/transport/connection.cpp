// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/connection.h"

namespace aureole {

namespace {

/// Transmittance of a surface for light that crosses it along `d` without deflection, in either direction.
Spectrum null_transmittance(const SurfacePoint& point, const Vec3& d, const Wavelengths& w) {
  if (!point.surface->passable) return 0.f;
  return point.surface->bsdf->null_transmittance(point.shading.to_local(-d), BsdfContext{w, point});
}

}  // namespace

bool is_lost(const Scene& scene, TestSegment& c) {
  if (scene.tracer().is_traceable(c.ray)) return false;
  c.lose();
  return true;
}

void travel(TestSegment& c, float t, const Wavelengths& w, SegmentEmission* emission) {
  // `t` is in units of the ray's direction; the distance in the medium is counted from surface to surface,
  // which the ray's endpoints are offset from.
  const float distance = t * length(c.ray.d) + c.offset + (t >= c.ray.t_max ? c.end_offset : 0.f);
  c.key = c.key * 0x9e3779b9u + 1;  // each medium on the segment has random numbers of its own
  const Transmittance s =
      transmittance(*c.medium, {c.ray.o - c.d * c.offset, c.d, kInfinity}, distance, w, c.key, emission);
  c.transmitted_before = c.transmitted;
  c.transmitted *= s.value;
  c.passage *= s.roulette;
}

Event cross(const SurfacePoint& point, TestSegment& c, const Wavelengths& w) {
  if (!(c.through_emitters && point.surface->light) && !c.is_inactive(point, w)) {
    const Spectrum passed = null_transmittance(point, c.d, w);
    c.passage *= passed;
    if (max_component(passed) >= TestSegment::kOpaque) c.clear_passage *= passed;
    if (is_black(c.passage) && !c.goes_behind) return Event::blocked;
    if (c.crossings_left != kUnlimitedCrossings && !point.surface->is_null() && --c.crossings_left < 0)
      return Event::blocked;
  }
  c.pass(point, c.d, c.d);
  c.ray.o = offset_origin(point, c.d);
  c.offset = distance_from_surface(c.ray.o - point.p, c.d);
  if (c.infinite) {
    c.ray.t_max = kInfinity;
    return Event::crossed;
  }
  c.ray.d = c.target - c.ray.o;
  // The march ends beyond a surface that the target lies on, since a ray back would hit that surface again
  // and again. It also ends on a segment within the plane of a surface, whose endpoints are offset to
  // different sides of the plane.
  const bool turned = dot(c.ray.d, point.ng) * dot(c.d, point.ng) < 0;
  return dot(c.ray.d, c.d) > 0 && !turned ? Event::crossed : Event::escape;
}

bool is_visible(const Scene& scene, TestSegment& c, const Wavelengths& w) {
  c.ray.time = w.time;
  if (scene.has_binary_visibility() && !c.through_emitters)
    return !scene.tracer().occluded(c.ray) || is_lost(scene, c);
  for (;;) {
    const Event event = cross(scene, scene.tracer().intersect(c.ray), c, w);
    if (event == Event::crossed) continue;
    if (event != Event::escape) return false;
    if (scene.has_media()) c.finish();
    return true;
  }
}

}  // namespace aureole
