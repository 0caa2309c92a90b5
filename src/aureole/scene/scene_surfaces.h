// SPDX-License-Identifier: Apache-2.0
// `SceneSurfaces`: the surfaces of a scene and the ray tracer that finds them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "aureole/scene/ray_tracer.h"
#include "aureole/scene/surface.h"

namespace aureole {

struct SceneSurfaces {
  /// All surfaces: one for each primitive of the scene, then the surfaces of the shapes in groups (for each
  /// instance whose media or priorities are its own), then the exits of surfaces with a BSSRDF.
  std::vector<Surface> all;
  std::shared_ptr<const RayTracer> tracer;
  bool any_passable = false;  ///< whether segments may cross null surfaces or media

  /// Returns the nearest surface point along a ray.
  std::optional<SurfacePoint> intersect(const Ray& ray) const {
    const RayTracer::Hit hit = tracer->intersect(ray);
    if (!hit) return {};
    return surface_point(hit, ray);
  }
  /// Returns the surface of a hit found by the ray tracer.
  const Surface& of(const RayTracer::Hit& hit) const {
    const Surface& found = all[hit.shape];
    return found.instance ? found.members[hit.geometry] : found;
  }
  /// Returns the surface point of a hit found by the ray tracer.
  SurfacePoint surface_point(const RayTracer::Hit& hit, const Ray& ray) const {
    const Surface& found = all[hit.shape];
    const Surface& surface = of(hit);
    // The point is a single object for both cases, so that the compiler constructs it directly in the caller
    // (return value optimisation).
    SurfacePoint point = found.instance
                             ? found.instance->surface_point(*surface.shape, hit, ray, surface.needs_tangent)
                             : surface.shape->surface_point(hit, ray, surface.needs_tangent);
    point.surface = &surface;
    return point;
  }
  /// Whether every segment is either visible or occluded, so that an occlusion query is enough.
  bool has_binary_visibility() const { return !any_passable; }
};

}  // namespace aureole
