// SPDX-License-Identifier: Apache-2.0
// The distance to the nearest surface as a picture.
#include "aureole/integrator/integrator.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/path_density.h"

namespace aureole {
namespace {

class DepthIntegrator final : public Integrator {
public:
  using Integrator::Integrator;

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>&, const BatchLog&) const override {
    const Arena::Frame frame;
    BatchRays rays(frame.arena(), paths.size());
    for (size_t i = 0; i < paths.size(); ++i) {
      paths[i].result = {};
      rays.add(int(i), paths[i].ray);
    }
    rays.intersect(scene.tracer(), RayTracer::Rays::coherent, [&](int i, const RayTracer::Hit& hit) {
      if (!hit) return;
      Path& path = paths[size_t(i)];
      const SurfacePoint point = scene.surface_point(hit, path.ray);
      path.result = {single_estimate(dot(point.p - path.ray.o, path.ray.d), path.wavelengths), 1};
    });
  }
};

AUREOLE_PLUGIN(
    DepthIntegrator, "integrator", "depth",
    PluginDoc{
        "The distance along the ray, not along the axis of the camera, from the near clip plane to the nearest "
        "surface in scene units; 0, with alpha 0, where there is no surface before the far clip plane. From the "
        "camera itself it is longer by near_clip over the cosine between ray and axis. It is stored as a flat "
        "spectral radiance: Y, or any channel with `response` \"uniform\", is the "
        "distance; R, G and B have the tint of a flat spectrum. The channel `depth` of `aov` is the distance "
        "itself.",
        "",
        {},
        {R"(<integrator type="depth"/>)"}});

}  // namespace
}  // namespace aureole
