// SPDX-License-Identifier: Apache-2.0
// Lights that move: their emitters are asked in the place in which they are written, and their answers are moved.
#include "aureole/emitter/light.h"

#include <algorithm>
#include <cmath>

namespace aureole {

namespace {

/// Bound of the rounding error of a moved point, given the one of the point at rest: rounded to single precision once more.
Vec3 moved_error(const Transform& t, const Vec3& error, const Vec3& moved) {
  const auto& m = t.matrix();
  Vec3 bound;
  for (std::size_t i = 0; i < 3; ++i)
    bound[int(i)] = float(std::abs(m[i][0]) * double(error.x) + std::abs(m[i][1]) * double(error.y) +
                          std::abs(m[i][2]) * double(error.z)) +
                    gamma_bound(6) * std::abs(moved[int(i)]);
  return bound;
}

SurfacePoint at_rest(const Transform& back, const SurfacePoint& point) {
  SurfacePoint p = point;
  p.p = back.point(point.p), p.ng = normalize(back.normal(point.ng));
  p.shading = Frame::from_normal(normalize(back.normal(point.shading.n)));
  p.instance = nullptr;  // its coordinates are those of the group already
  return p;
}

bool is_zero(const Vec3& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

}  // namespace

Spectrum Light::eval_moved(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const {
  const Transform back = motion->at(wavelengths.time).inverse();
  return emitter->eval(at_rest(back, point), normalize(back.vector(w)), wavelengths);
}

std::optional<DirectSample> Light::sample_direct_moved(const Vec3& reference, const Vec3& facing,
                                                       std::size_t part, Vec2 u,
                                                       const Wavelengths& wavelengths) const {
  const Transform there = motion->at(wavelengths.time), back = there.inverse();
  const Vec3 from = back.point(reference);
  auto s = is_zero(facing) ? emitter->sample_direct(*this, from, part, u, wavelengths)
                           : emitter->sample_direct_facing(*this, from, normalize(back.vector(facing)), part,
                                                           u, wavelengths);
  if (!s) return s;
  const bool on_surface = !is_zero(s->ng);
  s->p = there.point(s->p);
  if (on_surface) s->ng = normalize(there.normal(s->ng)), s->p_error = moved_error(there, s->p_error, s->p);
  s->wo = normalize(s->p - reference);
  return s;
}

std::optional<EmittedRay> Light::sample_ray_moved(std::size_t part, Vec2 position, Vec2 direction,
                                                  const Wavelengths& wavelengths) const {
  auto s = emitter->sample_ray(*this, part, position, direction, wavelengths);
  if (!s) return s;
  const Transform there = motion->at(wavelengths.time);
  s->p = there.point(s->p), s->d = normalize(there.vector(s->d));
  if (!is_zero(s->ng))
    s->ng = normalize(there.normal(s->ng)), s->p_error = moved_error(there, s->p_error, s->p);
  return s;
}

float Light::pdf_direct_moved(const Vec3& reference, std::size_t part, const SurfacePoint& point) const {
  const Transform back = motion->at(point.time).inverse();
  return emitter->pdf_direct(*this, back.point(reference), part, at_rest(back, point));
}

RayDensity Light::pdf_ray_moved(std::size_t part, const SurfacePoint* point, const Vec3& d,
                                float time) const {
  const Transform back = motion->at(time).inverse();
  const Vec3 direction = normalize(back.vector(d));
  if (!point) return emitter->pdf_ray(*this, part, nullptr, direction);
  const SurfacePoint rest = at_rest(back, *point);
  return emitter->pdf_ray(*this, part, &rest, direction);
}

EmissionBounds Light::emission_bounds_moved(std::size_t part) const {
  EmissionBounds b = emitter->emission_bounds(*this, part);
  const Bounds3 rest = b.box;
  Bounds3 all;
  // Between two of these times the light turns by at most a few degrees, or the key frames are many.
  constexpr int kTimes = 129;
  const int times = motion->is_moving() ? kTimes : 1;
  const Vec3 axis = normalize(motion->at(first_time).vector(b.axis));
  bool turns = false;
  for (int i = 0; i < times; ++i) {
    const Transform there =
        motion->at(times > 1 ? std::lerp(first_time, last_time, float(i) / float(times - 1)) : first_time);
    for (int corner = 0; corner < 8; ++corner)
      all.extend(
          there.point({corner & 1 ? rest.upper.x : rest.lower.x, corner & 2 ? rest.upper.y : rest.lower.y,
                       corner & 4 ? rest.upper.z : rest.lower.z}));
    turns = turns || dot(normalize(there.vector(b.axis)), axis) < 1 - 1e-5f;
  }
  const Vec3 margin = (all.upper - all.lower) * 0.01f;
  all.lower = all.lower - margin, all.upper = all.upper + margin;
  b.box = all, b.axis = axis;
  if (turns) b.cos_normals = -1;
  return b;
}

}  // namespace aureole
