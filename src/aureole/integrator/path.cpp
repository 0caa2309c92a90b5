// SPDX-License-Identifier: Apache-2.0
// Unidirectional spectral path tracer. The body is one scalar step, (path, hit) -> (next ray, connection), so
// that another driver may send the rays of many paths together.
#include <fmt/format.h>

#include <cmath>

#include "aureole/integrator/path_limits.h"
#include "aureole/integrator/scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// Sample dimensions of one vertex: pairs for directions, the BSDF's and the light's, and single numbers for
/// choices.
enum Choice { kLight, kLobe, kRoulette };

struct PathState {
  Ray ray;
  PathDensity density;  ///< up to and including the direction of `ray`
  int depth = 0;        ///< scattering events so far
  int vertex = 0;       ///< surfaces met so far, those that were passed without scattering among them
  float eta2 =
      1;  ///< squared index of the present medium over the camera's: undoes the n^2 of radiance for roulette
  RadianceEstimate result;

  // How `ray` was found, for MIS with light sampling: the density before its direction was sampled, and that
  // sample.
  bool found_by_density = false;  ///< false for camera rays and delta lobes, which light sampling cannot find
  PathDensity before;
  Weight value;
  Spectrum pdf;
  Vec3 from, facing;
};

/// What one step asks of the driver: whether to go on along state.ray, and a connection to be tested for
/// visibility. Where visibility is not a matter of yes or no the step has found it, and the contribution
/// holds it.
struct Step {
  bool alive, connects;
  Ray connection;
  Spectrum contribution;  ///< of the connection, if nothing is in the way
};

class PathIntegrator final : public RadianceIntegrator {
public:
  explicit PathIntegrator(const Properties& p) : RadianceIntegrator(p), limits_(p) {}

  RadianceEstimate radiance(const Scene& scene, const Ray& ray, const Wavelengths& w, SampleStream& samples,
                            const PathLog& log, float*) const override {
    PathState state;
    state.ray = ray;
    if (!limits_.reaches(1)) return state.result;
    for (;;) {
      const std::optional<SurfacePoint> hit = scene.intersect(state.ray);
      if (log) log_hit(log, state, hit);
      Step step;
      advance(scene, state, hit ? &*hit : nullptr, w, samples, step);
      if (step.connects) {
        const bool visible = !scene.has_binary_visibility() || !scene.tracer().occluded(step.connection);
        if (visible) state.result.estimate += step.contribution;
        if (log)
          log(fmt::format("  light: {} mean {:.6g}", visible ? "visible" : "hidden",
                          mean(step.contribution)));
      }
      if (!step.alive) return state.result;
    }
  }

  /// Paths in lock-step: the rays of a bounce, and its connections, go to the ray tracer as packets.
  void radiance_of(const Scene& scene, std::span<CameraPath> paths) const override {
    if (!limits_.reaches(1)) {
      for (CameraPath& p : paths) p.result = {};
      return;
    }
    const RayTracer& tracer = scene.tracer();
    PathState states[kTogether];
    RayPacket rays, shadow_rays;
    RayTracer::Hit hits[kTogether];
    int lane[kTogether], shadow_lane[kTogether];  // the path that a ray belongs to
    Step steps[kTogether + 1];                    // those that connect, and one more to be filled
    bool blocked[kTogether];
    int n = int(paths.size());
    for (int i = 0; i < n; ++i) lane[i] = i, rays.set(i, states[i].ray = paths[size_t(i)].ray);

    for (auto kind = RayTracer::Rays::coherent; n > 0; kind = RayTracer::Rays::incoherent) {
      tracer.intersect(rays, n, kind, hits);
      int alive = 0, shadows = 0;
      for (int i = 0; i < n; ++i) {
        const int l = lane[i];
        PathState& s = states[l];
        CameraPath& path = paths[size_t(l)];
        Step& step = steps[shadows];
        if (hits[i]) {
          const SurfacePoint point = scene.surface_point(hits[i], s.ray);
          advance(scene, s, &point, path.wavelengths, path.samples, step);
        } else {
          advance(scene, s, nullptr, path.wavelengths, path.samples, step);
        }
        if (step.connects && scene.has_binary_visibility()) {
          shadow_rays.set(shadows, step.connection);
          shadow_lane[shadows++] = l;
        } else if (step.connects) {
          s.result.estimate += step.contribution;
        }
        // `alive` is at most i: what is overwritten has been read.
        if (step.alive) rays.set(alive, s.ray), lane[alive++] = l;
      }
      tracer.occluded(shadow_rays, shadows, blocked);
      for (int i = 0; i < shadows; ++i)
        if (!blocked[i]) states[shadow_lane[i]].result.estimate += steps[i].contribution;
      n = alive;
    }
    for (size_t i = 0; i < paths.size(); ++i) paths[i].result = states[i].result;
  }

private:
  void advance(const Scene& scene, PathState& s, const SurfacePoint* hit, const Wavelengths& w,
               SampleStream& samples, Step& step) const {
    step.alive = step.connects = false;
    if (!hit) {
      // Vertex kind: escape.
      if (s.depth == 0) {
        s.result.alpha = limits_.hide_emitters || scene.infinite_emitters().empty() ? 0.f : 1.f;
        if (limits_.hide_emitters) return;
      }
      for (const Emitter* e : scene.infinite_emitters())
        add_emission(scene, s, *e, nullptr, e->eval_escaped(s.ray.d, w), w);
      return;
    }
    // Vertex kind: surface.
    const Vec3 to_previous = -s.ray.d;
    if (const Emitter* e = hit->shape->emitter()) {
      if (limits_.hide_emitters && s.depth == 0) {
        s.ray = {offset_origin(*hit, s.ray.d), s.ray.d, kInfinity};
        step.alive = true;
        return;
      }
      add_emission(scene, s, *e, hit, e->eval(*hit, to_previous, w), w);
    }
    const bool last = !limits_.reaches(s.depth + 2);
    if (last && !hit->shape->is_passable()) {
      if (s.depth == 0) s.result.alpha = 1;
      return;
    }

    const int v = s.vertex++;
    const float* directions = samples.directions(v);
    const Vec2 for_bsdf{directions[0], directions[1]}, for_light{directions[2], directions[3]};
    const auto choice = [&](Choice k) { return samples.get1(SampleStream::choice(v, k)); };
    const SurfaceVertex vertex(*hit, to_previous, w,
                               hit->shape->needs_choice() ? samples.key(SampleStream::choice(v, 0)) : 0);
    if (!last && vertex.is_smooth() && !scene.lights().empty()) {
      sample_light(scene, vertex, scene.lights().is_single() ? 0.f : choice(kLight), for_light, w,
                   [&](const LightConnection& c) {
                     const Spectrum other = c.direct.delta ? Spectrum(0.f) : c.scattering.pdf;
                     step.connects = true;
                     step.contribution =
                         s.density.contribution(c.scattering.value * c.direct.radiance, c.density, other, w);
                     if (scene.has_binary_visibility())
                       step.connection = Scene::connection_ray(*hit, c.direct);
                     else
                       step.contribution *= scene.connect(*hit, c.direct, w);
                   });
    }

    const auto b = vertex.sample(hit->shape->needs_choice() ? choice(kLobe) : 0.f, for_bsdf);
    if (b && has(b->lobe, Lobe::null)) {
      // No vertex: what was sampled before and light sampling, whose connections pass too, find the same
      // emitters beyond, so that the weights between them do not hold the mass of passing.
      const Weight passed = b->value * (1 / b->pdf[0]);
      if (is_black(passed)) return;
      s.density.beta *= passed;
      s.value *= passed;
      s.ray = {offset_origin(*hit, s.ray.d), s.ray.d, kInfinity};
      step.alive = true;
      return;
    }
    if (s.depth == 0) s.result.alpha = 1;
    if (last || !b || is_black(b->value)) return;
    s.before = s.density;
    s.value = b->value, s.pdf = b->pdf;
    s.found_by_density = !b->is_delta();
    s.from = hit->p, s.facing = vertex.facing_normal();
    s.density.extend(b->value, b->pdf);
    s.ray = {offset_origin(*hit, b->wo), b->wo, kInfinity};
    ++s.depth;
    s.eta2 *= b->eta * b->eta;

    if (s.depth >= limits_.roulette_depth) {
      const float survival = std::min(0.95f, s.density.hero_symmetric_throughput() * s.eta2);
      if (!(choice(kRoulette) < survival)) return;
      s.density.survive(survival);
      s.before.survive(survival);
    }
    // The last ray can only bring emission.
    step.alive = limits_.reaches(s.depth + 2) || scene.may_meet_emitter(s.ray);
  }

  void add_emission(const Scene& scene, PathState& s, const Emitter& emitter, const SurfacePoint* hit,
                    const Spectrum& radiance, const Wavelengths& w) const {
    if (is_black(radiance)) return;
    if (!s.found_by_density) {
      s.result.estimate += s.density.contribution(radiance, w);
      return;
    }
    const float light = light_density(scene, s.from, s.facing, emitter, hit, s.ray.d);
    s.result.estimate += s.before.contribution(s.value * radiance, s.pdf, light, w);
  }

  static void log_hit(const PathLog& log, const PathState& s, const std::optional<SurfacePoint>& hit) {
    if (!hit) {
      log(fmt::format("  depth {}: escapes along ({:.6g}, {:.6g}, {:.6g})", s.depth, s.ray.d.x, s.ray.d.y,
                      s.ray.d.z));
      return;
    }
    log_surface(log, s.depth, *hit, s.density.hero_symmetric_throughput());
  }

  PathLimits limits_;
};

AUREOLE_PLUGIN(
    PathIntegrator, "integrator", "path",
    PluginDoc{
        "Path tracer: next-event estimation and BSDF sampling combined by spectral multiple importance "
        "sampling.",
        "Kajiya 1986; Veach 1997, chapters 9 and 10; Wilkie et al. 2014, Eq. 8",
        {{"max_depth", "integer", "", "-1",
          "longest path in edges: 1 shows emitters only, 2 direct light; -1: no limit"},
         {"rr_depth", "integer", "", "5", "Russian roulette begins after this many surfaces, 1000 at most"},
         {"hide_emitters", "boolean", "", "false",
          "camera rays pass through area emitters and see no environment"}},
        {R"(<integrator type="path"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <boolean name="hide_emitters" value="false"/></integrator>)"}});

}  // namespace
}  // namespace aureole
