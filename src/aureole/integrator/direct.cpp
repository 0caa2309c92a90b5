// SPDX-License-Identifier: Apache-2.0
// Direct illumination only, with chosen numbers of light and BSDF samples.
#include "aureole/integrator/integrator.h"
#include "aureole/integrator/scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class DirectIntegrator final : public RadianceIntegrator {
public:
  explicit DirectIntegrator(const Properties& p) : RadianceIntegrator(p) {
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
                            SampleStream& samples, const PathLog&, float*) const override {
    RadianceEstimate result;
    Ray ray = camera_ray;
    Weight passed = 1.f;
    for (int dimension = 0;;) {
      const auto hit = scene.intersect(ray);
      if (hide_emitters_ && hit && hit->shape->emitter()) {
        ray = {offset_origin(*hit, ray.d), ray.d, kInfinity};
        continue;
      }
      const PathDensity density{passed};
      if (!hide_emitters_) result.estimate += density.contribution(emission(scene, hit, ray.d, w), w);
      if (!hit) {
        if (!hide_emitters_ && !scene.infinite_emitters().empty()) result.alpha = 1;
        return result;
      }
      add_reflected(scene, *hit, ray.d, density, w, samples, dimension, result);

      // A surface that lets some light pass: go on behind it with the probability of that.
      const Weight through = Scene::null_transmittance(*hit, ray.d, w);
      const float probability = std::min(1.f, mean(through));
      if (!(probability > 0) || !(samples.get1(dimension++) < probability)) break;
      passed *= through * (1 / probability);
      ray = {offset_origin(*hit, ray.d), ray.d, kInfinity};
    }
    result.alpha = 1;
    return result;
  }

private:
  /// Light that arrives at `hit` and scatters once.
  void add_reflected(const Scene& scene, const SurfacePoint& hit, const Vec3& d, const PathDensity& density,
                     const Wavelengths& w, SampleStream& samples, int& dimension,
                     RadianceEstimate& result) const {
    const SurfaceVertex vertex(hit, -d, w, samples.key(dimension));
    const bool smooth = vertex.bsdf().is_smooth() && !scene.lights().empty();
    for (int i = 0; smooth && i < light_samples_; ++i, dimension += 3) {
      sample_light(scene, vertex, samples.get1(dimension), samples.get2(dimension + 1), w,
                   [&](const LightConnection& c) {
                     const Spectrum other =
                         c.direct.delta ? Spectrum(0.f) : c.scattering.pdf * float(bsdf_samples_);
                     result.estimate += density.contribution(c.scattering.value * c.direct.radiance,
                                                             c.density * float(light_samples_), other, w) *
                                        scene.connect(hit, c.direct, w);
                   });
    }
    for (int i = 0; i < bsdf_samples_; ++i, dimension += 3) {
      const auto b = vertex.sample(samples.get1(dimension), samples.get2(dimension + 1));
      if (!b || is_black(b->value) || has(b->lobe, Lobe::null)) continue;
      Ray next{offset_origin(hit, b->wo), b->wo, kInfinity};
      Weight value = b->value;
      const auto add = [&](const Emitter& e, const SurfacePoint* point, const Spectrum& radiance) {
        if (is_black(radiance)) return;
        const float light = b->is_delta() || !smooth
                                ? 0.f
                                : float(light_samples_) *
                                      light_density(scene, hit.p, vertex.facing_normal(), e, point, next.d);
        result.estimate += density.contribution(value * radiance, b->pdf * float(bsdf_samples_), light, w);
      };
      while (const auto light_hit = scene.intersect(next)) {
        if (const Emitter* e = light_hit->shape->emitter())
          add(*e, &*light_hit, e->eval(*light_hit, -next.d, w));
        value *= Scene::null_transmittance(*light_hit, next.d, w);
        if (is_black(value)) break;
        next.o = offset_origin(*light_hit, next.d);
      }
      if (!is_black(value))
        for (const Emitter* e : scene.infinite_emitters()) add(*e, nullptr, e->eval_escaped(next.d, w));
    }
  }

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
