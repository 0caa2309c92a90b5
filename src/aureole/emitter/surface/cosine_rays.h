// SPDX-License-Identifier: Apache-2.0
// Rays and bounds of emitters that are surfaces of shapes.
#pragma once

#include <optional>

#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/shape/area_sampler.h"

namespace aureole {

/// Samples a ray from a point of the shape, uniform over the area of a patch, in a direction with a density
/// proportional to the cosine. `radiance(sample, d)` is the emitted radiance of that point in the direction
/// d.
template <class Radiance>
std::optional<EmittedRay> sample_cosine_ray(const Light& light, std::size_t part, Vec2 position,
                                            Vec2 direction, const Radiance& radiance) {
  const auto s = light.area->sample_area(part, position);
  if (!s) return {};
  const Vec3 local = square_to_cosine_hemisphere(direction);
  const Vec3 d = normalize(Frame::from_normal(s->ng).to_world(local));
  return EmittedRay{
      s->p, s->p_error, s->ng, d, radiance(*s, d) * local.z, s->pdf, cosine_hemisphere_pdf(local.z)};
}

/// Returns the pdfs of `sample_cosine_ray`.
inline RayDensity cosine_ray_density(const Light& light, std::size_t part, const SurfacePoint& point,
                                     const Vec3& d) {
  const float cosine = dot(point.ng, d);
  return {light.area->pdf_area(part, point), cosine > 0 ? cosine_hemisphere_pdf(cosine) : 0.f};
}

/// Returns the area of a patch as a fraction of the shape's area.
inline float patch_fraction(const Light& light, std::size_t part) {
  return light.surface_area > 0 ? float(light.area->patch_area(part) / light.surface_area) : 0;
}

}  // namespace aureole
