// SPDX-License-Identifier: Apache-2.0
// The distance to the nearest surface as a picture.
#include "aureole/integrator/integrator.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class DepthIntegrator final : public RadianceIntegrator {
public:
  using RadianceIntegrator::RadianceIntegrator;

  RadianceEstimate radiance(const Scene& scene, const Ray& ray, const Wavelengths& w, SampleStream&,
                            const PathLog&, float*) const override {
    const auto hit = scene.intersect(ray);
    if (!hit) return {};
    return {PathDensity{}.contribution(dot(hit->p - ray.o, ray.d), w), 1};
  }
};

AUREOLE_PLUGIN(
    DepthIntegrator, "integrator", "depth",
    PluginDoc{
        "The distance along the ray from the near clipping plane to the nearest surface in scene units, 0 "
        "where "
        "there is none, as a flat spectral radiance: Y, or any channel with `response` \"uniform\", is the "
        "distance; R, G and B have the tint of a flat spectrum. The channel `depth` of `aov` is the distance "
        "itself.",
        "",
        {},
        {R"(<integrator type="depth"/>)"}});

}  // namespace
}  // namespace aureole
