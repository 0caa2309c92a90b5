// SPDX-License-Identifier: Apache-2.0
// Light tracing: paths from the emitters, connected to the sensor at every vertex. Such a path has one
// technique, and spectral MIS weights it over the wavelengths, whose densities differ only by those of its
// BSDF samples. Emitters that the sensor sees directly, which no connection finds, are found by rays of the
// sensor.
#include <fmt/format.h>

#include <algorithm>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/path_limits.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/emerge.h"
#include "aureole/transport/endpoints.h"
#include "aureole/transport/sight.h"

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

/// Paths from the emitters.
class LightSteps {
public:
  LightSteps(const Scene& scene, const PathLimits& limits, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log)
      : scene_(scene),
        walks_to_edges_(scene.edges() && !scene.edges()->empty()),
        limits_(limits),
        paths_(paths),
        splats_(splats),
        log_(log),
        counts_crossings_(scene.sensor().counts_crossings()),
        counts_beams_(counts_crossings_ && limits.reaches(1) && !limits.hide_emitters) {}

  const Ray& ray(int path) const { return states_[path].flight.ray; }
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  /// Whether paths of one edge count.
  bool counts_beams() const { return counts_beams_; }
  bool needs_march() const { return !scene_.has_binary_visibility() || limits_.hide_emitters; }
  std::uint32_t connection_key(int i) const {
    return key(paths_[size_t(i)].samples, states_[i].vertex, Key::connection);
  }

  /// Where the path begins; false where it carries no light.
  bool emit(int i) {
    Path& path = paths_[size_t(i)];
    State& s = states_[i];
    Vec2 u = path.samples.get2(SampleStream::choice(0, int(Choice::light)));
    const EmittingMedia* media = scene_.emitting_media();
    const float share = media ? float(media->power() / (media->power() + scene_.lights().power())) : 0.f;
    if (u.x < share) return emit_from_medium(i, *media, u.x / share, share);
    if (share > 0) u.x = std::min((u.x - share) / (1 - share), 0x1.fffffep-1f);
    const auto choice = scene_.lights().choose_by_power(u);
    if (!choice) return false;
    const auto emitted = choice->light->sample_ray(choice->part, get(path.samples, 0, Pair::connection),
                                                   get(path.samples, 0, Pair::scatter), path.wavelengths);
    if (!emitted || is_black(emitted->value)) return false;
    const float pdf = (1 - share) * choice->probability * emitted->pdf_position * emitted->pdf_direction;
    if (!(pdf > 0)) return false;
    s.density.beta = Weight(emitted->value);
    s.density.survive(pdf);
    s.whole = s.density.hero_symmetric_throughput();
    s.flight.ray = Anchor::of(*emitted).leave(emitted->d);
    find_surroundings(scene_, choice->light, s.flight);
    if (log_.follows(i)) log_emitter(log_, *choice->light, choice->part, s.flight.ray);
    // A beam that no connection finds; that from infinity is found by those of the receivers.
    if (counts_beams_ && emitted->delta_direction && !choice->light->is_infinite())
      pass_receivers(i, Anchor::of(*emitted), emitted->d, [&] { return s.flight; });
    return true;
  }

  /// Begins a path at an edge that a light shines on, instead of a ray of the light.
  bool begin_at_edge(int i) {
    Path& path = paths_[size_t(i)];
    EdgePaths edges(scene_, path.wavelengths, key(path.samples, 0, Key::connection) ^ kFromLight,
                    limits_.hide_emitters);
    Spectrum value = 1.f;
    EdgePaths::AtEdge at;
    if (!limits_.reaches(3) || !edges.begin_at_light(value, at)) return false;
    State& s = states_[i];
    s.whole = max_component(abs(value));
    return go_on_from_edge(i, edges, at, value);
  }

  Event arrive(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if (s.flight.medium) {
      const Event event = fly(i, hit ? hit.t : kInfinity);
      if (event != Event::crossed) return event;
    }
    if (!hit) return Event::escape;
    lend(i, hit.t);
    Path& path = paths_[size_t(i)];
    Vertex& vertex = vertices_.make(
        i, [&] { return Vertex(scene_, hit, s.flight, path.wavelengths, TransportMode::importance); });
    ++s.vertex;
    if (s.flight.is_hidden(vertex.surface())) {
      go_on(i, vertex, s.flight.ray.d);
      return Event::crossed;
    }
    if (s.after_edge.is_set && !vertex.is_passable() &&
        !s.after_edge.leaves_beam(scene_, vertex.p(), path.wavelengths, s.density))
      return Event::blocked;
    vertex.prepare(key(path.samples, s.vertex), s.flight);
    if (log_.follows(i))
      log_surface(log_, s.scattered + 1, vertex.point(), s.density.hero_symmetric_throughput() / s.whole);
    return Event::surface;
  }

  void lose(int i) { paths_[size_t(i)].result.invalidate(); }

  bool connect(int i, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    s.is_seen = false;
    if (!vertex.is_smooth()) return false;
    // Rays of the sensor pass through the surfaces of emitters.
    if (limits_.hide_emitters && vertex.light()) return false;
    Path& path = paths_[size_t(i)];
    const Vec2 lens = scene_.sensor().uses_lens() ? get(path.samples, s.vertex, Pair::connection) : Vec2{};
    if (!connect_to_sensor(scene_, vertex, s.flight, s.density, lens, path.wavelengths,
                           scene_.has_media() ? key(path.samples, s.vertex, Key::connection) : 0, out,
                           film_[i]))
      return false;
    out.through_emitters = limits_.hide_emitters;
    return true;
  }

  void connected(int i, const Connection& c, bool open) {
    if (open) splats_.push_back({i, film_[i], c.light});
    states_[i].is_seen = open;
    if (log_.follows(i)) log_seen(log_, film_[i], c, open);
  }

  /// Connects the vertices with the sensor around edges.
  void connect_around_edges(const PathList& vertices) {
    for (const int i : vertices) {
      const State& s = states_[i];
      const Vertex& vertex = vertices_[i];
      if (!vertex.is_smooth() || !limits_.reaches(s.scattered + 3)) continue;
      Path& path = paths_[size_t(i)];
      EdgePaths edges(scene_, path.wavelengths, key(path.samples, s.vertex, Key::connection) ^ kToSensor,
                      limits_.hide_emitters);
      see_around_edge(i, edges, EdgePaths::at_vertex(vertex, s.flight), s.is_seen, left(s),
                      [&](const Vec3& d) { return EdgePaths::response(vertex, d); });
    }
  }
  bool looks_around_edges() const { return walks_to_edges_; }

  bool scatter(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    const Vertex& vertex = vertices_[i];
    const float to_edge = walks_to_edges_ && vertex.is_smooth() && limits_.reaches(s.scattered + 4)
                              ? EdgePaths::to_edge(scene_, vertex.p(), path.wavelengths)
                              : 0;
    if (to_edge > 0) {
      KeyedRandom random(key(path.samples, s.vertex, Key::connection) ^ kAroundEdges);
      if (random.next() < to_edge) {
        EdgePaths edges(scene_, path.wavelengths, random, limits_.hide_emitters);
        return walk_to_edge(i, edges, to_edge);
      }
    }
    const bool last = !limits_.reaches(s.scattered + 3);
    if (last && !vertex.is_passable() && !vertex.has_exit() && !counts_crossings_) return false;
    const float lobe = vertex.needs_choice() ? get(path.samples, s.vertex, Choice::lobe) : 0.f;
    Scatter b;
    const Event event = vertex.scatter(lobe, get(path.samples, s.vertex, Pair::scatter), b);
    if (event == Event::blocked) return false;
    if (event == Event::crossed) {
      s.density.attenuate(b.value);
      if (to_edge > 0) s.density.survive(1 - to_edge);
      go_on(i, vertex, b.d);
      return true;
    }
    if (to_edge > 0) b.pdf *= 1 - to_edge;
    const bool ends = last && event != Event::entered;
    if ((ends && !b.delta) || b.value.is_black()) return false;
    s.after_edge.is_set = false;
    s.density.extend(b.value, b.pdf, b.delta);
    if (counts_crossings_ && b.delta)
      pass_receivers(i, vertex.anchor(), b.d, [&] { return vertex.surroundings(b.d, s.flight); });
    if (ends) return false;
    if (event == Event::entered) {
      below_.add(i);
      return false;
    }
    go_on(i, vertex, b.d);
    ++s.scattered;
    if (!survives(i)) return false;
    if (s.flight.medium)
      end_at_event(s.flight, path.wavelengths, get(path.samples, s.vertex, Choice::distance));
    return true;
  }

  /// As that of `path`.
  PathList emerge() {
    PathList vertices;
    for (const int i : std::exchange(below_, {})) {
      State& s = states_[i];
      Path& path = paths_[size_t(i)];
      if (!aureole::emerge(scene_, vertices_, i, path.wavelengths, path.samples, TransportMode::importance,
                           s.vertex, s.density, s.flight))
        continue;
      if (log_.follows(i))
        log_exit(log_, vertices_[i].point(), s.density.hero_symmetric_throughput() / s.whole);
      vertices.add(i);
    }
    return vertices;
  }

private:
  /// The same from a place in a medium.
  bool emit_from_medium(int i, const EmittingMedia& media, float u, float share) {
    Path& path = paths_[size_t(i)];
    State& s = states_[i];
    KeyedRandom third(key(path.samples, 0));
    const EmittingMedia::Place place = media.sample_by_power(
        std::min(u, 0x1.fffffep-1f), get(path.samples, 0, Pair::connection), third.next());
    const Vec3 d = square_to_uniform_sphere(get(path.samples, 0, Pair::scatter));
    s.flight.ray = {place.p, d, kInfinity};
    find_surroundings(scene_, s.flight);
    if (s.flight.medium != place.medium) return false;
    if (const MajorantGrid* grid = place.medium->majorants(); grid && !(grid->at(place.p) > 0)) return false;
    MediumCoefficients at;
    place.medium->eval(place.p, d, path.wavelengths, at);
    const float pdf = share * place.pdf * uniform_sphere_pdf();
    if (is_black(at.emission) || !(pdf > 0)) return false;
    s.density.beta = Weight(at.emission);
    s.density.survive(pdf);
    s.whole = s.density.hero_symmetric_throughput();
    if (log_.follows(i))
      log_(fmt::format("  medium \"{}\": from ({:.6g}, {:.6g}, {:.6g}) along ({:.6g}, {:.6g}, {:.6g})",
                       place.medium->id(), place.p.x, place.p.y, place.p.z, d.x, d.y, d.z));
    return true;
  }

  // These make other keys of one.
  static constexpr std::uint32_t kToSensor = 0x2545f491u, kAroundEdges = 0x7feb352du,
                                 kFromLight = 0x846ca68bu;

  /// Light that a mirror or a beam has sent along `d`, which no connection finds, where it passes the sensor's
  /// receivers.
  template <class Surroundings>
  void pass_receivers(int i, const Anchor& from, const Vec3& d, const Surroundings& surroundings) {
    const State& s = states_[i];
    const Path& path = paths_[size_t(i)];
    scene_.sensor().for_crossings(from.leave(d), [&](const SensorCrossing& crossing) {
      Connection c;
      c.set(from, d, Anchor::in_space(crossing.p));
      c.through_emitters = limits_.hide_emitters;
      c.light = s.density.reached(Weight(1.f), crossing.importance, path.wavelengths);
      if (scene_.has_media()) {
        c.begin_in(surroundings(), key(path.samples, s.vertex, Key::connection));
        c.own = 1.f / kWavelengths, c.other = 0.f;
      }
      const bool open = aureole::connect(scene_, c, path.wavelengths);
      if (open && scene_.has_media()) c.finish();
      if (open) lend_to_edges(scene_, LightWay::of(c), path.wavelengths, connection_key(i), c.light);
      if (open) splats_.push_back({i, crossing.film, c.light});
      if (log_.follows(i)) log_seen(log_, crossing.film, c, open);
    });
  }

  struct State {
    Flight flight;
    LightPathDensity density;
    float whole = 1;  ///< throughput at the emitter: roulette asks how much of the light is left, not how
                      ///< bright it is
    int vertex = 0;   ///< vertices met; 0 at the emitter
    int scattered = 0, in_media = 0;
    AfterEdge after_edge;
    bool is_seen = false;  ///< the sensor sees the vertex
  };

  void go_on(int i, const Vertex& vertex, const Vec3& d) {
    vertex.leave(d, scene_.has_media(), states_[i].flight);
  }

  /// What edges beside the flight take of it, over that distance.
  void lend(int i, float t) {
    State& s = states_[i];
    const Path& path = paths_[size_t(i)];
    lend_to_edges(scene_, s.flight.ray, t, s.after_edge.end(), path.wavelengths,
                  key(path.samples, s.vertex, Key::flight), s.density);
  }

  /// The part of the light that is left.
  static float left(const State& s) { return s.density.hero_symmetric_throughput() / s.whole; }

  /// Roulette; false where the path ends.
  bool survives(int i) {
    State& s = states_[i];
    if (s.scattered < limits_.roulette_depth) return true;
    const float survival = std::min(PathLimits::most_survival(scene_, s.scattered), left(s));
    if (!(get(paths_[size_t(i)].samples, s.vertex, Choice::roulette) < survival)) return false;
    s.density.survive(survival);
    return true;
  }

  template <class Respond>
  void see_around_edge(int i, EdgePaths& edges, const EdgePaths::Place& from, bool is_seen, float left,
                       const Respond& respond) {
    Vec2 film;
    const Vec2 lens = edges.next2();
    const Spectrum seen = edges.to_sensor(from, is_seen, left, lens, respond, film);
    if (is_black(seen)) return;
    const Spectrum estimate = states_[i].density.reached(Weight(seen), 1, paths_[size_t(i)].wavelengths);
    splats_.push_back({i, film, estimate});
    if (log_.follows(i))
      log_(fmt::format("  sensor around an edge at ({:.6g}, {:.6g}) on the film: mean {:.6g}", film.x, film.y,
                       mean(estimate)));
  }

  // As those of `path`.
  [[gnu::noinline]] bool walk_to_edge(int i, EdgePaths& edges, float probability) {
    State& s = states_[i];
    Spectrum value;
    EdgePaths::AtEdge at;
    if (!edges.walk(vertices_[i], s.flight, probability, value, at)) return false;
    ++s.scattered;
    return go_on_from_edge(i, edges, at, value);
  }
  bool go_on_from_edge(int i, EdgePaths& edges, const EdgePaths::AtEdge& first, const Spectrum& value) {
    State& s = states_[i];
    const auto see = [&](const EdgePaths::AtEdge& at, const Spectrum& so_far) {
      if (log_.follows(i)) log_edge(log_, s.scattered, at.point.p);
      see_around_edge(i, edges, at.place(), false, 1,
                      [&](const Vec3& d) { return so_far * edges.kernel(at, d); });
    };
    if (!edges.leave(
            first, value, s.scattered, [&](int n) { return limits_.reaches(n); }, see, s.density, s.flight,
            s.after_edge))
      return false;
    ++s.vertex;
    return survives(i);
  }

  /// As that of `path`.
  [[gnu::noinline]] Event fly(int i, float t_max) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    Vec3 p;
    if (!aureole::fly(s.flight, t_max, path.wavelengths, path.samples, s.vertex, s.density, nullptr, p))
      return Event::crossed;
    lend(i, length(p - s.flight.ray.o));
    if (log_.follows(i))
      log_medium(log_, s.scattered + 1, p, *s.flight.medium, s.density.hero_symmetric_throughput() / s.whole);
    if (s.in_media == limits_.max_scattering || s.density.beta.is_black()) return Event::blocked;
    if (s.after_edge.is_set && !s.after_edge.leaves_beam(scene_, p, path.wavelengths, s.density))
      return Event::blocked;
    ++s.in_media, ++s.vertex;
    vertices_.make(i, [&] { return Vertex({p, s.flight.medium}, -s.flight.ray.d, path.wavelengths); });
    return Event::medium;
  }

  const Scene& scene_;
  const bool walks_to_edges_;
  const PathLimits& limits_;
  std::span<Path> paths_;
  std::vector<Splat>& splats_;
  const BatchLog& log_;
  const bool counts_crossings_, counts_beams_;
  State states_[kBatch];
  PerPath<Vertex> vertices_;
  PathList below_;     ///< that have gone on below a surface
  Vec2 film_[kBatch];  ///< where a connection's light falls
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
    LightSteps steps(scene, limits_, paths, splats, log);
    const bool goes_on = limits_.reaches(2);
    if (!goes_on && !steps.counts_beams()) return;
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i)
      if (steps.emit(int(i)) && goes_on) rays.add(int(i), steps.ray(int(i)));
    if (!goes_on) return;
    follow(scene, steps, rays, RayTracer::Rays::incoherent);
    if (scene.edges() && !scene.edges()->empty()) begin_at_edges(scene, paths, splats, log);
  }

private:
  /// Light that comes from edges first: seen by the sensor, and on its way.
  [[gnu::noinline]] void begin_at_edges(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                                        const BatchLog& log) const {
    // Random numbers of their own.
    std::array<Path, kBatch> second;
    for (size_t i = 0; i < paths.size(); ++i) {
      second[i] = paths[i];
      second[i].samples = paths[i].samples.of_second_path();
    }
    LightSteps steps(scene, limits_, {second.data(), paths.size()}, splats, log);
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i) {
      if (const auto splat = light_seen_around_edge(scene, int(i), paths[i], limits_.hide_emitters))
        splats.push_back(*splat);
      if (steps.begin_at_edge(int(i))) rays.add(int(i), steps.ray(int(i)));
    }
    follow(scene, steps, rays, RayTracer::Rays::incoherent);
    for (size_t i = 0; i < paths.size(); ++i)
      if (!is_finite(second[i].result.estimate)) paths[i].result.invalidate();
  }

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
        log(fmt::format("  the sensor sees an emitter: mean {:.6g}", mean(seen.sum[i])));
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
              "longest path in edges: 1 shows emitters only, 2 direct light; -1: no limit"},
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
