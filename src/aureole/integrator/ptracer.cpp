// SPDX-License-Identifier: Apache-2.0
// Light tracing: paths from the emitters, connected to the sensor at every surface. A path X found so has one
// technique only, the same for all wavelengths but for what its BSDF samples say: spectral MIS is over
// wavelengths. What a connection can't carry, emitters that the sensor sees, a ray of the sensor finds.
#include <fmt/format.h>

#include <algorithm>

#include "aureole/integrator/path_limits.h"
#include "aureole/integrator/scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// Sample dimensions, of the emission (vertex 0) and of each surface: pairs for directions and places, single
/// numbers for choices.
enum Pair { kEmittedDirection = 0, kEmittedPosition = 1, kBsdfDirection = 0, kLens = 1 };
enum Choice { kPart = 0, kLobe = 0, kRoulette = 1 };

Vec2 pair(SampleStream& samples, int vertex, Pair which) {
  return samples.get2(SampleStream::direction(vertex, which));
}
float choice(SampleStream& samples, int vertex, Choice which) {
  return samples.get1(SampleStream::choice(vertex, which));
}

class ParticleTracer final : public SplatIntegrator {
public:
  explicit ParticleTracer(const Properties& p) : SplatIntegrator(p), limits_(p) {
    if (p.has("samples_per_pass"))
      p.note("samples_per_pass", "work is divided by itself: \"samples_per_pass\" has no effect");
    p.get_int("samples_per_pass", -1);
  }

  void trace(const Scene& scene, const Wavelengths& w, SampleStream& samples, std::vector<Splat>& splats,
             const PathLog& log) const override {
    if (!limits_.reaches(2)) return;
    const auto light = scene.lights().choose_by_power(samples.get2(SampleStream::choice(0, kPart)));
    if (!light) return;
    const auto emitted = light->emitter->sample_ray(light->part, pair(samples, 0, kEmittedPosition),
                                                    pair(samples, 0, kEmittedDirection), w);
    if (!emitted || is_black(emitted->value)) return;
    const float pdf = light->probability * emitted->pdf_position * emitted->pdf_direction;
    if (!(pdf > 0)) return;
    PathDensity density;
    density.beta = emitted->value;
    density.survive(pdf);
    // Roulette asks how much of the light is left, not how bright it is.
    const float whole = density.hero_symmetric_throughput();
    Ray ray{offset_origin(emitted->p, emitted->p_error, emitted->ng, emitted->d), emitted->d, kInfinity};
    if (log)
      log(fmt::format(
          "  emitter \"{}\", part {}: from ({:.6g}, {:.6g}, {:.6g}) along ({:.6g}, {:.6g}, {:.6g})",
          light->emitter->properties().type(), light->part, ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y,
          ray.d.z));

    int scattered = 0;
    for (int v = 1;; ++v) {
      const std::optional<SurfacePoint> hit = scene.intersect(ray);
      if (!hit) return;
      const SurfaceVertex vertex(*hit, -ray.d, w, samples.key(SampleStream::choice(v, 0)),
                                 TransportMode::importance);
      if (log) log_surface(log, scattered + 1, *hit, density.hero_symmetric_throughput() / whole);
      connect(scene, vertex, density, w, samples, v, splats, log);

      const bool last = !limits_.reaches(scattered + 3);
      if (last && !hit->shape->is_passable()) return;
      const auto b = vertex.sample(hit->shape->needs_choice() ? choice(samples, v, kLobe) : 0.f,
                                   pair(samples, v, kBsdfDirection));
      if (!b || is_black(b->value)) return;
      if (has(b->lobe, Lobe::null)) {
        // No vertex: the mass of passing is not a density of the path.
        density.beta *= b->value * (1 / b->pdf[0]);
        ray = {offset_origin(*hit, ray.d), ray.d, kInfinity};
        continue;
      }
      if (last) return;
      density.extend(b->value * vertex.adjoint_correction(b->wo), b->pdf);
      if (is_black(density.beta)) return;
      ray = {offset_origin(*hit, b->wo), b->wo, kInfinity};
      ++scattered;
      if (scattered < limits_.roulette_depth) continue;
      const float survival = std::min(0.95f, density.hero_symmetric_throughput() / whole);
      if (!(choice(samples, v, kRoulette) < survival)) return;
      density.survive(survival);
    }
  }

  Spectrum seen_directly(const Scene& scene, const Ray& camera_ray, const Wavelengths& w,
                         const PathLog& log) const override {
    if (limits_.hide_emitters || !limits_.reaches(1) || !scene.may_meet_emitter(camera_ray)) return 0.f;
    Spectrum sum = 0.f;
    Weight passed = 1.f;
    Ray ray = camera_ray;
    while (const auto hit = scene.intersect(ray)) {
      if (const Emitter* e = hit->shape->emitter()) sum += passed * e->eval(*hit, -ray.d, w);
      passed *= Scene::null_transmittance(*hit, ray.d, w);
      if (is_black(passed)) break;
      ray = {offset_origin(*hit, ray.d), ray.d, kInfinity};
    }
    if (!is_black(passed))
      for (const Emitter* e : scene.infinite_emitters()) sum += passed * e->eval_escaped(ray.d, w);
    if (log && !is_black(sum)) log(fmt::format("  the sensor sees an emitter: mean {:.6g}", mean(sum)));
    return PathDensity{}.contribution(sum, w);
  }

private:
  void connect(const Scene& scene, const SurfaceVertex& vertex, const PathDensity& density,
               const Wavelengths& w, SampleStream& samples, int v, std::vector<Splat>& splats,
               const PathLog& log) const {
    if (!vertex.is_smooth()) return;
    // Rays of the sensor pass through the surfaces of emitters.
    if (limits_.hide_emitters && vertex.point().shape->emitter()) return;
    const Sensor& sensor = scene.sensor();
    const auto seen =
        sensor.sample_direct(vertex.point().p, sensor.uses_lens() ? pair(samples, v, kLens) : Vec2{});
    if (!seen || !(seen->importance > 0)) return;
    const Weight value = vertex.eval_pdf(seen->wo).value;
    if (is_black(value)) return;
    DirectSample end;
    end.wo = seen->wo, end.p = seen->p;
    const Spectrum visible = scene.connect(vertex.point(), end, w, limits_.hide_emitters);
    const Spectrum estimate =
        density.contribution(value * (vertex.adjoint_correction(seen->wo) * seen->importance), w) * visible;
    if (!is_black(visible)) splats.push_back({seen->film, estimate});
    if (log)
      log(fmt::format("  sensor at ({:.6g}, {:.6g}) on the film: {} mean {:.6g}", seen->film.x, seen->film.y,
                      is_black(visible) ? "hidden" : "visible", mean(estimate)));
  }

  PathLimits limits_;
};

AUREOLE_PLUGIN(
    ParticleTracer, "integrator", "ptracer",
    PluginDoc{
        "Light tracing: paths start at the emitters and are connected to the sensor at every surface. Finds "
        "caustics that a path tracer can't, and shows nothing through smooth glass or in mirrors, since no "
        "connection passes those. Emitters and backgrounds that the sensor sees are found by its own rays. "
        "As "
        "many paths are traced as there are samples on the film.",
        "Veach 1997, section 10.3 (s = 0, 1) with section 5.3 for shading normals; Wilkie et al. 2014, Eq. 8",
        {{"max_depth", "integer", "", "-1",
          "longest path in edges: 1 shows emitters only, 2 direct light; -1: no limit"},
         {"rr_depth", "integer", "", "5", "Russian roulette begins after this many surfaces, 1000 at most"},
         {"hide_emitters", "boolean", "", "false",
          "the sensor sees through area emitters and sees no environment"},
         {"samples_per_pass", "integer", "", "-1", "accepted without effect"}},
        {R"(<integrator type="ptracer"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <boolean name="hide_emitters" value="false"/><integer name="samples_per_pass" value="16"/></integrator>)"}});

}  // namespace
}  // namespace aureole
