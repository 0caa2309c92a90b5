// SPDX-License-Identifier: Apache-2.0
// Unidirectional spectral path tracer. The body is one scalar step, (path, hit) -> (next ray, connection), so
// that another driver may send the rays of many paths together.
#include <fmt/format.h>

#include <cmath>

#include "aureole/integrator/integrator.h"
#include "aureole/integrator/scattering.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// Sample dimensions of one vertex.
enum Dimension { kLight, kLightU, kLightV, kBsdfU, kBsdfV, kLobe, kRoulette, kPerVertex };

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
  Vec3 from, light_normal;
};

/// What one step asks of the driver: whether to go on along state.ray, and a connection to be tested for
/// visibility.
struct Step {
  bool alive = false;
  bool connects = false;
  DirectSample connection;
  Spectrum contribution;  ///< of the connection, if nothing is in the way
};

class PathIntegrator final : public RadianceIntegrator {
public:
  explicit PathIntegrator(const Properties& p) : RadianceIntegrator(p) {
    max_depth_ = int(p.get_int("max_depth", -1, {-1, 1e9}));
    roulette_depth_ = std::min(int(p.get_int("rr_depth", 5, {1, 1e9})), kLatestRoulette);
    hide_emitters_ = p.get_bool("hide_emitters", false);
  }

  RadianceEstimate radiance(const Scene& scene, const Ray& ray, const Wavelengths& w, SampleStream& samples,
                            const PathLog& log, float*) const override {
    PathState state;
    state.ray = ray;
    if (max_depth_ == 0) return state.result;
    for (;;) {
      const std::optional<SurfacePoint> hit = scene.intersect(state.ray);
      if (log) log_hit(log, state, hit);
      const Step step = advance(scene, state, hit, w, samples);
      if (step.connects) {
        const Spectrum visible = scene.connect(*hit, step.connection, w);
        state.result.estimate += step.contribution * visible;
        if (log)
          log(fmt::format("  light along ({:.6g}, {:.6g}, {:.6g}): {} mean {:.6g}", step.connection.wo.x,
                          step.connection.wo.y, step.connection.wo.z,
                          is_black(visible) ? "hidden" : "visible", mean(step.contribution)));
      }
      if (!step.alive) return state.result;
    }
  }

private:
  Step advance(const Scene& scene, PathState& s, const std::optional<SurfacePoint>& hit, const Wavelengths& w,
               SampleStream& samples) const {
    Step step;
    if (!hit) {
      // Vertex kind: escape.
      if (s.depth == 0) {
        s.result.alpha = hide_emitters_ || scene.infinite_emitters().empty() ? 0.f : 1.f;
        if (hide_emitters_) return step;
      }
      for (const Emitter* e : scene.infinite_emitters())
        add_emission(scene, s, *e, nullptr, e->eval_escaped(s.ray.d, w), w);
      return step;
    }
    // Vertex kind: surface.
    const Vec3 to_previous = -s.ray.d;
    if (const Emitter* e = hit->shape->emitter()) {
      if (hide_emitters_ && s.depth == 0) {
        s.ray = {offset_origin(*hit, s.ray.d), s.ray.d, kInfinity};
        step.alive = true;
        return step;
      }
      add_emission(scene, s, *e, &*hit, e->eval(*hit, to_previous, w), w);
    }
    const bool last = max_depth_ >= 0 && s.depth + 1 >= max_depth_;
    if (last && !hit->shape->bsdf()->is_passable()) {
      if (s.depth == 0) s.result.alpha = 1;
      return step;
    }

    const int dimension = kPerVertex * s.vertex++;
    const SurfaceVertex vertex(*hit, to_previous, w, samples.key(dimension));
    if (!last && vertex.bsdf().is_smooth() && !scene.lights().empty()) {
      const auto c =
          sample_light(scene, vertex, samples.get1(dimension + kLight), samples.get2(dimension + kLightU), w);
      if (c) {
        const Spectrum other = c->direct.delta ? Spectrum(0.f) : c->scattering.pdf;
        step.connects = true;
        step.connection = c->direct;
        step.contribution =
            s.density.contribution(c->scattering.value * c->direct.radiance, c->density, other, w);
      }
    }

    const auto b = vertex.sample(samples.get1(dimension + kLobe), samples.get2(dimension + kBsdfU));
    if (b && has(b->lobe, Lobe::null)) {
      // No vertex: what was sampled before and light sampling, whose connections pass too, find the same
      // emitters beyond, so that the weights between them do not hold the mass of passing.
      const Weight passed = b->value * (1 / b->pdf[0]);
      if (is_black(passed)) return step;
      s.density.beta *= passed;
      s.value *= passed;
      s.ray = {offset_origin(*hit, b->wo), b->wo, kInfinity};
      step.alive = true;
      return step;
    }
    if (s.depth == 0) s.result.alpha = 1;
    if (last || !b || is_black(b->value)) return step;
    s.before = s.density;
    s.value = b->value, s.pdf = b->pdf;
    s.found_by_density = !b->is_delta();
    s.from = hit->p, s.light_normal = vertex.light_normal();
    s.density.extend(b->value, b->pdf);
    s.ray = {offset_origin(*hit, b->wo), b->wo, kInfinity};
    ++s.depth;
    s.eta2 *= b->eta * b->eta;

    if (s.depth >= roulette_depth_) {
      const float survival = std::min(0.95f, s.density.hero_symmetric_throughput() * s.eta2);
      if (!(samples.get1(dimension + kRoulette) < survival)) return step;
      s.density.survive(survival);
      s.before.survive(survival);
    }
    step.alive = true;
    return step;
  }

  void add_emission(const Scene& scene, PathState& s, const Emitter& emitter, const SurfacePoint* hit,
                    const Spectrum& radiance, const Wavelengths& w) const {
    if (is_black(radiance)) return;
    if (!s.found_by_density) {
      s.result.estimate += s.density.contribution(radiance, w);
      return;
    }
    const float light = light_density(scene, s.from, s.light_normal, emitter, hit, s.ray.d);
    s.result.estimate += s.before.contribution(s.value * radiance, s.pdf, light, w);
  }

  static void log_hit(const PathLog& log, const PathState& s, const std::optional<SurfacePoint>& hit) {
    if (!hit) {
      log(fmt::format("  depth {}: escapes along ({:.6g}, {:.6g}, {:.6g})", s.depth, s.ray.d.x, s.ray.d.y,
                      s.ray.d.z));
      return;
    }
    log(fmt::format("  depth {}: {} \"{}\" at ({:.6g}, {:.6g}, {:.6g}), bsdf {}, throughput {:.6g}", s.depth,
                    hit->shape->properties().type(), hit->shape->id(), hit->p.x, hit->p.y, hit->p.z,
                    hit->shape->bsdf()->properties().type(), s.density.hero_symmetric_throughput()));
  }

  /// Inside a closed shape without losses no path would end without roulette.
  static constexpr int kLatestRoulette = 1000;

  int max_depth_, roulette_depth_;
  bool hide_emitters_;
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
