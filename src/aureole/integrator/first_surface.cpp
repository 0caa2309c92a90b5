// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/first_surface.h"

#include <algorithm>

#include "aureole/transport/ray_origin.h"

namespace aureole {

void find_first_surfaces(const Scene& scene, std::span<const Ray> rays, RayTracer::Rays kind,
                         FirstSurface found[]) {
  constexpr int kMaxCrossings = 1000;
  const auto stops = [](const Surface& surface) {
    return surface.light || has(surface.lobes, Lobe::reflect | Lobe::transmit);
  };
  const Arena::Frame frame;
  BatchRays left(frame.arena(), rays.size());
  Ray* const next = frame.arena().allocate<Ray>(rays.size());
  int* const crossings = frame.arena().allocate<int>(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    next[i] = rays[i], crossings[i] = 0, found[i] = {};
    left.add(int(i), next[i]);
  }
  while (!left.empty())
    left.intersect(scene.tracer(), kind, [&](int i, const RayTracer::Hit& hit) {
      if (!hit) return;
      const Ray& ray = rays[std::size_t(i)];
      const SurfacePoint point = scene.surface_point(hit, next[i]);
      const float distance = dot(point.p - ray.o, ray.d);
      if (stops(*point.surface)) {
        const Vec3 before = offset_origin(point.p, point.p_error, point.ng, -ray.d);
        found[i] = {std::max(0.f, std::min(distance, dot(before - ray.o, ray.d))), before};
        return;
      }
      next[i] = RayOrigin::of(point).spawn(ray.d);
      next[i].t_max = ray.t_max - distance;
      if (next[i].t_max > 0 && ++crossings[i] < kMaxCrossings) left.add(i, next[i]);
    });
}

}  // namespace aureole
