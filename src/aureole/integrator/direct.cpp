// SPDX-License-Identifier: Apache-2.0
// Direct illumination only, with chosen numbers of light and BSDF samples.
#include "aureole/integrator/integrator.h"
#include "aureole/integrator/scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class DirectIntegrator final : public Integrator {
public:
  explicit DirectIntegrator(const Properties& p) : Integrator(p) {
    const auto shading = p.get_int("shading_samples", 1, {0, 65536});
    if (p.has("shading_samples") && (p.has("emitter_samples") || p.has("bsdf_samples")))
      throw p.error("shading_samples",
                    "give either \"shading_samples\" or \"emitter_samples\" and \"bsdf_samples\"");
    light_samples_ = int(p.get_int("emitter_samples", shading, {0, 65536}));
    bsdf_samples_ = int(p.get_int("bsdf_samples", shading, {0, 65536}));
    if (light_samples_ + bsdf_samples_ == 0) throw p.error("bsdf_samples", "at least one sample is needed");
    hide_emitters_ = p.get_bool("hide_emitters", false);
  }

  RadianceEstimate radiance(const Scene& scene, const Ray& camera_ray, const Wavelengths& w,
                            SampleStream& samples, const PathLog&) const override {
    RadianceEstimate result;
    const PathDensity density;
    Ray ray = camera_ray;
    auto hit = scene.intersect(ray);
    while (hide_emitters_ && hit && hit->shape->emitter()) {
      ray = {offset_origin(*hit, ray.d), ray.d, kInfinity};
      hit = scene.intersect(ray);
    }
    if (!hide_emitters_) result.estimate = density.contribution(emission(scene, hit, ray.d, w), w);
    result.alpha = hit || (!hide_emitters_ && !scene.infinite_emitters().empty()) ? 1.f : 0.f;
    if (!hit) return result;

    int dimension = kCameraDimensions;
    const SurfaceVertex vertex(*hit, -ray.d, w, samples.key(dimension));
    const bool smooth = vertex.bsdf().is_smooth() && !scene.lights().empty();
    for (int i = 0; smooth && i < light_samples_; ++i, dimension += 3) {
      const auto c = sample_light(scene, vertex, samples.get1(dimension), samples.get2(dimension + 1), w);
      if (!c) continue;
      const Spectrum other = c->direct.delta ? Spectrum(0.f) : c->scattering.pdf * float(bsdf_samples_);
      result.estimate += density.contribution(c->scattering.value * c->direct.radiance,
                                              c->density * float(light_samples_), other, w) *
                         scene.connect(*hit, c->direct);
    }
    for (int i = 0; i < bsdf_samples_; ++i, dimension += 3) {
      const auto b = vertex.sample(samples.get1(dimension), samples.get2(dimension + 1));
      if (!b || is_black(b->value)) continue;
      const Ray next{offset_origin(*hit, b->wo), b->wo, kInfinity};
      const auto light_hit = scene.intersect(next);
      const auto add = [&](const Emitter& e, const SurfacePoint* point, const Spectrum& radiance) {
        if (is_black(radiance)) return;
        const float light = b->is_delta() || !smooth
                                ? 0.f
                                : float(light_samples_) *
                                      light_density(scene, hit->p, vertex.light_normal(), e, point, next.d);
        result.estimate += density.contribution(b->value * radiance, b->pdf * float(bsdf_samples_), light, w);
      };
      if (light_hit) {
        if (const Emitter* e = light_hit->shape->emitter())
          add(*e, &*light_hit, e->eval(*light_hit, -next.d, w));
      } else {
        for (const Emitter* e : scene.infinite_emitters()) add(*e, nullptr, e->eval_escaped(next.d, w));
      }
    }
    return result;
  }

private:
  static Spectrum emission(const Scene& scene, const std::optional<SurfacePoint>& hit, const Vec3& d,
                           const Wavelengths& w) {
    if (hit) return hit->shape->emitter() ? hit->shape->emitter()->eval(*hit, -d, w) : Spectrum(0.f);
    Spectrum sum = 0.f;
    for (const Emitter* e : scene.infinite_emitters()) sum += e->eval_escaped(d, w);
    return sum;
  }

  int light_samples_, bsdf_samples_;
  bool hide_emitters_;
};

AUREOLE_PLUGIN(
    DirectIntegrator, "integrator", "direct",
    PluginDoc{
        "Direct illumination: light that scatters once, by any number of light and BSDF samples combined by "
        "spectral "
        "multiple importance sampling.",
        "Veach 1997, chapter 9",
        {{"shading_samples", "integer", "", "1", "number of each of the two kinds of samples"},
         {"emitter_samples", "integer", "", "shading_samples", "samples of lights"},
         {"bsdf_samples", "integer", "", "shading_samples", "samples of the BSDF"},
         {"hide_emitters", "boolean", "", "false", "camera rays pass through emitters"}},
        {R"(<integrator type="direct"><integer name="emitter_samples" value="2"/><integer name="bsdf_samples" value="1"/>
    <boolean name="hide_emitters" value="true"/></integrator>)",
         R"(<integrator type="direct"><integer name="shading_samples" value="4"/></integrator>)"}});

}  // namespace
}  // namespace aureole
