// SPDX-License-Identifier: Apache-2.0
// Light tracing: paths from the lights, connected with the sensor at every vertex. Such a path has one technique, and spectral MIS weights it
// over the wavelengths, whose pdfs differ only by those of its BSDF samples. Lights that the sensor sees directly, which no connection finds,
// are found by rays of the sensor.
#include <algorithm>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/sight.h"
#include "aureole/transport/walk.h"

namespace aureole {
namespace {

/// Radiance that the sensor's rays see directly.
class SeenDirectly {
public:
  SeenDirectly(std::span<Path> paths, bool hides_emitters) : paths_(paths), hides_emitters_(hides_emitters) {}
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  void see(int path, const Light&, const SurfacePoint*, const Vec3&, const Spectrum& radiance) {
    if (!hides_emitters_) sum[path] += radiance;
  }
  void lose(int path) { sum[path] = std::numeric_limits<float>::quiet_NaN(); }
  Glow glow(int) const { return {}; }
  void see(int path, const Spectrum& light) { media[path] += light / paths_[size_t(path)].wavelengths.pdf; }

  Spectrum sum[kBatch];
  Spectrum media[kBatch];  ///< estimates of the light of media

private:
  std::span<Path> paths_;
  bool hides_emitters_;  ///< media are none
};

struct LightKind {
  static constexpr Space kSpace = Space::any;
  static constexpr bool kEmerges = true;
  using Density = LightPathDensity;
  struct State {};
  using Vertices = PerPath<aureole::Vertex>;
};

/// Paths from the lights.
class LightWalk : public Walk<LightWalk, LightKind> {
public:
  LightWalk(const WalkInput& in, std::vector<Splat>& splats)
      : Walk(in),
        splats_(splats),
        counts_crossings_(in.scene.sensor().counts_crossings()),
        counts_beams_(counts_crossings_ && in.limits.reaches(1) && !in.limits.hide_emitters) {}

  /// Whether paths of one segment count.
  bool counts_beams() const { return counts_beams_; }

  /// Begins a path at a light, or in a medium that emits; false where it carries no light.
  bool start(int i) {
    Path& p = path(i);
    Vec2 u = p.samples.get2(SampleStream::choice(0, int(Choice::light)));
    const EmittingMedia* media = scene_.emitting_media();
    const float share = media ? float(media->power() / (media->power() + scene_.lights().power())) : 0.f;
    if (u.x < share) return start_in_medium(i, *media, u.x / share, share);
    if (share > 0) u.x = std::min((u.x - share) / (1 - share), 0x1.fffffep-1f);
    const auto emitted = begin_at_light(i, u, 1 - share);
    if (!emitted) return false;
    // A beam that no connection finds; one from infinity is found by the connections of the receivers.
    if (counts_beams_ && emitted->ray.delta_direction && !emitted->choice.light->is_infinite())
      cross_receivers(i, Anchor::of(emitted->ray), emitted->ray.d, [&] { return states_[i].flight; });
    return true;
  }

  bool connect(int i, int, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!vertex.is_smooth()) return false;
    // Rays of the sensor pass through the surfaces of lights.
    if (limits_.hide_emitters && vertex.light()) return false;
    Path& p = path(i);
    const Vec2 lens = scene_.sensor().uses_lens() ? get(p.samples, s.vertex, Pair::connection) : Vec2{};
    if (!connect_to_sensor(scene_, vertex, s.flight, s.density, lens, p.wavelengths,
                           scene_.has_media() ? key(p.samples, s.vertex, Key::connection) : 0, out, film_[i]))
      return false;
    out.through_emitters = limits_.hide_emitters;
    return true;
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) splat(i, film_[i], c.light);
    if (log_.follows(i)) log_sensor(c, film_[i], open);
  }
  void splat(int i, Vec2 film, const Spectrum& estimate) { splats_.push_back({i, film, estimate}); }

  // Hooks of the walk:
  bool follows_last(int) const { return counts_crossings_; }
  void scattered(int i, const Scatter& b) {
    if (!counts_crossings_ || !b.delta) return;
    const Vertex& vertex = vertices_[i];
    cross_receivers(i, vertex.anchor(), b.d, [&] { return vertex.surroundings(b.d, states_[i].flight); });
  }

private:
  bool start_in_medium(int i, const EmittingMedia& media, float u, float share) {
    Path& p = path(i);
    State& s = states_[i];
    KeyedRandom third(key(p.samples, 0));
    const EmittingMedia::Place place =
        media.sample_by_power(std::min(u, 0x1.fffffep-1f), get(p.samples, 0, Pair::connection), third.next());
    const Vec3 d = square_to_uniform_sphere(get(p.samples, 0, Pair::scatter));
    s.flight.ray = {place.p, d, kInfinity};
    find_surroundings(scene_, s.flight);
    if (s.flight.medium != place.medium) return false;
    if (const MajorantGrid* grid = place.medium->majorants(); grid && !(grid->at(place.p) > 0)) return false;
    MediumCoefficients at;
    place.medium->eval(place.p, d, p.wavelengths, at);
    const float pdf = share * place.pdf * uniform_sphere_pdf();
    if (is_black(at.emission) || !(pdf > 0)) return false;
    s.density.beta = Weight(at.emission);
    s.density.survive(pdf);
    s.first_throughput = s.density.hero_symmetric_throughput();
    if (log_.follows(i))
      log_({.kind = PathEvent::Kind::start, .p = place.p, .d = d, .in_medium = place.medium});
    return true;
  }

  /// Light that a mirror or a beam has sent along `d`, which no connection finds, where it crosses the sensor's receivers.
  template <class Surroundings>
  void cross_receivers(int i, const Anchor& from, const Vec3& d, const Surroundings& surroundings) {
    const State& s = states_[i];
    const Path& p = path(i);
    scene_.sensor().for_crossings(from.leave(d), [&](const SensorCrossing& crossing) {
      Connection c;
      c.set(from, d, Anchor::in_space(crossing.p));
      c.through_emitters = limits_.hide_emitters;
      c.light = s.density.reached(Weight(1.f), crossing.importance, p.wavelengths);
      if (scene_.has_media()) {
        c.begin_in(surroundings(), key(p.samples, s.vertex, Key::connection));
        c.own = 1.f / kWavelengths, c.other = 0.f;
      }
      const bool open = aureole::connect(scene_, c, p.wavelengths);
      if (open && scene_.has_media()) c.finish();
      if (open) lend_to_edges(scene_, LightWay::of(c), p.wavelengths, connection_key(i), c.light);
      if (open) splat(i, crossing.film, c.light);
      if (log_.follows(i)) log_sensor(c, crossing.film, open);
    });
  }

  std::vector<Splat>& splats_;
  const bool counts_crossings_, counts_beams_;
  Vec2 film_[kBatch];  ///< where the light of a connection falls
};

class ParticleTracer final : public Integrator {
public:
  explicit ParticleTracer(const Properties& p) : Integrator(p), limits_(p), diffraction_(get_diffraction(p)) {
    if (p.has("samples_per_pass"))
      p.note("samples_per_pass", "work is divided by itself: \"samples_per_pass\" has no effect");
    p.get_int("samples_per_pass", -1);
  }

  Leaves leaves() const override { return Leaves::film; }
  SceneNeeds needs() const override { return {diffraction_}; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }

  bool shows_emitters() const override { return limits_.reaches(1) && !limits_.hide_emitters; }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    see_directly(scene, paths, log);
    const WalkInput in{scene, limits_, paths, log};
    LightWalk walk(in, splats);
    const bool goes_on = limits_.reaches(2);
    if (!goes_on && !walk.counts_beams()) return;
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i)
      if (walk.start(int(i)) && goes_on) rays.add(int(i), walk.ray(int(i)));
    if (!goes_on) return;
    follow(scene, walk, rays, RayTracer::Rays::incoherent);
    follow_edge_paths(in, 1, true, splats, [&](const WalkInput& second, const auto& begin) {
      LightWalk from_edges(second, splats);
      begin(from_edges, rays);
      follow(scene, from_edges, rays, RayTracer::Rays::incoherent);
    });
  }

private:
  /// The radiance along the sensor's rays that connections can't bring to the film.
  void see_directly(const Scene& scene, std::span<Path> paths, const BatchLog& log) const {
    SeenDirectly seen(paths, limits_.hide_emitters);
    SightSteps sight(scene, seen);
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i) {
      paths[i].result = {};
      if (!limits_.reaches(1) || !scene.may_meet_emitter(paths[i].ray)) continue;
      if (limits_.hide_emitters && !scene.has_media()) continue;
      Flight flight{paths[i].ray, nullptr, {}};
      find_surroundings(scene, nullptr, flight);
      sight.begin(int(i), flight, 1.f, key(paths[i].samples, -1, Key::flight), limits_.hide_emitters);
      rays.add(int(i), paths[i].ray);
    }
    follow(scene, sight, rays, RayTracer::Rays::coherent);
    for (size_t i = 0; i < paths.size(); ++i) {
      if (log.follows(int(i)) && !is_black(seen.sum[i]))
        log({.kind = PathEvent::Kind::other,
             .estimate = single_estimate(seen.sum[i], paths[i].wavelengths),
             .text = "the sensor sees an emitter"});
      paths[i].result.estimate = single_estimate(seen.sum[i], paths[i].wavelengths) + seen.media[i];
    }
  }

  PathLimits limits_;
  std::optional<BeamWidth> diffraction_;
};

AUREOLE_PLUGIN(
    ParticleTracer, "integrator", "ptracer",
    PluginDoc{
        "Light tracing: paths start at the emitters and are connected to the sensor at every vertex. Finds "
        "caustics that a path tracer can't, and shows nothing through smooth glass or in mirrors, since no "
        "connection passes those. Emitters and backgrounds that the sensor sees are found by its own rays. "
        "As "
        "many paths are traced as there are samples on the film.",
        "Veach 1997, section 10.3 (s = 0, 1) with section 5.3 for shading normals; Wilkie et al. 2014, Eq. 8",
        with_diffraction_parameters(
            {{"max_depth", "integer", "", "-1",
              "longest path in segments: 1 shows emitters only, 2 direct light; -1: no limit"},
             {"rr_depth", "integer", "", "5",
              "Russian roulette begins after this many vertices, 1000 at most"},
             {"max_scattering", "integer", "", "-1",
              "paths that media scatter more often do not count: 1 is single scattering; -1: no limit"},
             {"hide_emitters", "boolean", "", "false",
              "the sensor sees through area emitters and sees no environment"},
             {"samples_per_pass", "integer", "", "-1", "accepted without effect"}}),
        {R"(<integrator type="ptracer"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/><integer name="samples_per_pass" value="16"/></integrator>)",
         R"(<integrator type="ptracer"><boolean name="diffraction" value="true"/><string name="beam_width" value="fresnel 2m"/></integrator>)"}});

}  // namespace
}  // namespace aureole
