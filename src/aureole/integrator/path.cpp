// SPDX-License-Identifier: Apache-2.0
// Unidirectional spectral path tracer.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/path_limits.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/driver.h"
#include "aureole/transport/edges.h"
#include "aureole/transport/emerge.h"
#include "aureole/transport/segment.h"
#include "aureole/transport/sight.h"

namespace aureole {
namespace {

/// Further state of a path in scenes of `Space::any`.
struct PathInSpace {
  int in_media = 0;     ///< scattering events in media
  Spectrum by_light;    ///< at a vertex in a medium: the density of its place had a light chosen it, relative
                        ///< to that of the hero's walk
  Spectrum share{1.f};  ///< of `EmissionSearch`
  PathDensity looked_from;  ///< where the line of sight began
  /// It brings all that is emitted along the ray and behind what lets the ray pass; also true after an
  /// edge, where connections from before it have counted the lights that the ray meets.
  bool looked = false;
  float to_edge = 0;    ///< probability of leaving the vertex for an edge
  float whole = 1;      ///< throughput of a path that begins at an edge: roulette asks how much of it is left
  bool is_lit = false;  ///< the vertex has light of the lamp that was asked
  AfterEdge after_edge;
};
struct PathInEmptySpace {};

template <Space kSpace>
class PathSteps {
  using Vertex = BasicVertex<kSpace>;
  static constexpr bool kAny = kSpace == Space::any;

public:
  PathSteps(const Scene& scene, const PathLimits& limits, std::span<Path> paths, const BatchLog& log)
      : scene_(scene),
        media_(kAny ? connected_media(scene) : nullptr),
        // Weights along flights do not count walks to edges.
        lights_choose_places_(kAny && !scene.edges() && scene.lights().tree().can_be_connected()),
        walks_to_edges_(kAny && scene.edges() && !scene.edges()->empty()),
        limits_(limits),
        paths_(paths),
        log_(log) {
    for (size_t i = 0; i < paths.size(); ++i) {
      states_[i].flight.ray = paths[i].ray;
      if constexpr (kAny) find_surroundings(scene, nullptr, states_[i].flight);
    }
    if (has_media()) sight_.emplace(scene, *this);
  }

  /// Begins a path at an edge that the sensor sees at `film`, instead of the sensor's ray; false where there is none.
  bool begin_at_edge(int i, Vec2& film) requires kAny {
    Path& path = paths_[size_t(i)];
    if (!limits_.reaches(3)) return false;
    EdgePaths edges(scene_, path.wavelengths, key(path.samples, 0, Key::connection) ^ kFromSensor,
                    limits_.hide_emitters);
    const Vec2 lens = edges.next2();
    Spectrum value = 1.f;
    EdgePaths::AtEdge at;
    if (!edges.begin_at_sensor(lens, value, at, film)) return false;
    states_[i].whole = max_component(abs(value));
    return go_on_from_edge(i, edges, at, value);
  }

  const Ray& ray(int path) const { return states_[path].flight.ray; }
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  bool needs_march() const { return !scene_.has_binary_visibility(); }
  std::uint32_t connection_key(int i) const {
    return key(paths_[size_t(i)].samples, states_[i].vertex, Key::connection);
  }
  void put_segments(BatchConnections* room) requires kAny { segments_ = room; }
  bool looks_for_emission() const requires kAny { return media_ != nullptr; }

  Event arrive(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if constexpr (kAny)
      if (s.flight.medium) {
        look_ahead(i, hit);
        const Event event = fly(i, hit ? hit.t : kInfinity);
        if (event != Event::crossed) return event;
      }
    if constexpr (kAny) lend(i, hit ? hit.t : kInfinity);
    if (!hit) return escape(i);
    Path& path = paths_[size_t(i)];
    Vertex& vertex = vertices_.make(
        i, [&] { return Vertex(scene_, hit, s.flight, path.wavelengths, TransportMode::radiance); });
    if (log_.follows(i)) log_surface(log_, s.depth, vertex.point(), s.density.hero_symmetric_throughput());
    if (kAny && s.flight.is_hidden(vertex.surface())) {
      ++s.vertex;  // the flight behind has random numbers of its own
      go_on(i, vertex, s.flight.ray.d);
      return Event::crossed;
    }
    if (const Light* light = vertex.light()) {
      if (limits_.hide_emitters && s.depth == 0) {
        s.vertex += has_media();  // the flight behind has random numbers of its own
        go_on(i, vertex, s.flight.ray.d);
        return Event::crossed;
      }
      add_emission(i, *light, &vertex.point(),
                   light->eval(vertex.point(), -s.flight.ray.d, path.wavelengths));
    }
    s.last = !limits_.reaches(s.depth + 2);
    if (s.last && !vertex.surface().passable) {
      if (s.depth == 0) path.result.alpha = 1;
      return Event::blocked;
    }
    // A surface that may be passed is taken for one that is: it is no vertex then.
    if constexpr (kAny)
      if (s.after_edge.is_set && !vertex.is_passable() &&
          !s.after_edge.leaves_beam(scene_, vertex.p(), path.wavelengths, s.density))
        return Event::blocked;
    s.pairs = path.samples.directions(++s.vertex);
    vertex.prepare(vertex.surface().needs_choice ? key(path.samples, s.vertex) : 0, s.flight);
    return Event::surface;
  }

  void lose(int i) { paths_[size_t(i)].result.invalidate(); }

  // Emission seen along lines of sight (`look_ahead`):
  void finish_looking() requires kAny {
    if (!lines_.empty()) follow(scene_, *sight_, lines_, RayTracer::Rays::incoherent);
  }
  Glow glow(int i) const { return {.ratio = states_[i].looked_from.ratio}; }
  void see(int i, const Spectrum& light) {
    Path& path = paths_[size_t(i)];
    path.result.estimate += states_[i].looked_from.beta.of(light) / path.wavelengths.pdf;
    if (log_.follows(i)) log_(fmt::format("  seen through media: mean {:.6g}", mean(light)));
  }
  void see(int i, const Light&, const SurfacePoint*, const Vec3&, const Spectrum& radiance) {
    if (!is_black(radiance)) see(i, radiance * (1 / sum(states_[i].looked_from.ratio)));
  }

  // `connect` and `scatter` are called once each, and large: GCC would not inline them (1 % of a path's instructions).
  [[gnu::always_inline]] bool connect(int i, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    SampleCounts counts;
    const Spectrum* by_light = nullptr;
    if constexpr (kAny) {
      s.is_lit = false;
      s.to_edge = may_walk_to_edge(s, vertex)
                      ? EdgePaths::to_edge(scene_, vertex.p(), paths_[size_t(i)].wavelengths)
                      : 0;
      counts.scatter = 1 - s.to_edge;
      if (!vertex.is_surface()) {
        if (!scene_.lights_reach(*s.flight.medium)) return false;
        by_light = &s.by_light;
      }
    }
    if (s.last || !vertex.is_smooth() || scene_.lights().empty()) return false;
    Path& path = paths_[size_t(i)];
    return connect_to_light(scene_, vertex, s.flight, s.density,
                            scene_.lights().is_single() ? 0.f : get(path.samples, s.vertex, Choice::light),
                            get(s.pairs, Pair::connection), path.wavelengths, counts,
                            has_media() ? key(path.samples, s.vertex, Key::connection) : 0, out, by_light);
  }

  bool connect_to_emission(int i, Connection& out) requires kAny {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (s.last || !vertex.is_smooth()) return false;
    Path& path = paths_[size_t(i)];
    // The numbers of the connection with a light: the two add up.
    return aureole::connect_to_emission(scene_, vertex, s.flight, s.density,
                                        get(path.samples, s.vertex, Choice::light),
                                        get(s.pairs, Pair::connection), path.wavelengths, {},
                                        key(path.samples, s.vertex, Key::connection) ^ kOther, out);
  }

  void connected(int i, const Connection& c, bool open) {
    if (open) paths_[size_t(i)].result.estimate += c.light;
    if constexpr (kAny) states_[i].is_lit |= open;
    if (log_.follows(i))
      log_(fmt::format("  light: {} mean {:.6g}", open ? "visible" : "hidden", mean(c.light)));
  }

  [[gnu::always_inline]] bool scatter(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    const Vertex& vertex = vertices_[i];
    if constexpr (kAny)
      if (s.to_edge > 0) {
        KeyedRandom random(key(path.samples, s.vertex, Key::connection) ^ kAroundEdges);
        if (random.next() < s.to_edge) {
          EdgePaths edges(scene_, path.wavelengths, random);
          return walk_to_edge(i, edges);
        }
      }
    const float lobe = vertex.needs_choice() ? get(path.samples, s.vertex, Choice::lobe) : 0.f;
    Scatter b;
    const Event event = vertex.scatter(lobe, get(s.pairs, Pair::scatter), b);
    if (event == Event::crossed) {
      s.density.attenuate(b.value);
      if constexpr (kAny)
        if (s.to_edge > 0) s.density.survive(1 - s.to_edge);
      go_on(i, vertex, b.d);
      return true;
    }
    if constexpr (kAny)
      if (s.to_edge > 0) b.pdf *= 1 - s.to_edge;
    if (s.depth == 0) path.result.alpha = 1;
    if (event == Event::blocked || s.last) return false;
    if constexpr (kAny) s.looked = s.after_edge.is_set = false;
    s.density.extend(b.value, b.pdf, b.delta);
    if (event == Event::entered) {
      below_.add(i);
      return false;
    }
    if constexpr (kAny) {
      s.share = 1.f;
      if (!vertex.is_surface()) {
        const Spectrum walked = s.density.light_ratio;
        s.density.light_ratio += s.by_light * (1 / b.pdf[0]);
        if (media_) s.share = safe_divide(walked, s.density.light_ratio);
      }
    }
    s.from = {vertex.p(), vertex.facing()};
    go_on(i, vertex, b.d);
    ++s.depth;
    s.eta2 *= b.eta * b.eta;
    if (!survives(i)) return false;
    if constexpr (kAny)
      if (!vertex.is_surface() && !may_choose_places(s))
        end_at_event(s.flight, path.wavelengths, get(path.samples, s.vertex, Choice::distance));
    return true;
  }

  /// Adds the light that reaches the vertices around edges.
  void connect_around_edges(const PathList& vertices) requires kAny {
    for (const int i : vertices) {
      const State& s = states_[i];
      const Vertex& vertex = vertices_[i];
      if (s.last || !vertex.is_smooth() || !limits_.reaches(s.depth + 3)) continue;
      Path& path = paths_[size_t(i)];
      EdgePaths edges(scene_, path.wavelengths, key(path.samples, s.vertex, Key::connection) ^ kOther);
      const Spectrum light =
          edges.from_light(EdgePaths::at_vertex(vertex, s.flight),
                           s.is_lit ? EdgePaths::Beside::direct : EdgePaths::Beside::surfaces, left(s),
                           [&](const Vec3& d) { return EdgePaths::response(vertex, d); });
      path.result.estimate += s.density.contribution(light, path.wavelengths);
      if (log_.follows(i) && !is_black(light))
        log_(fmt::format("  light around an edge: mean {:.6g}", mean(light)));
    }
  }
  bool looks_around_edges() const requires kAny { return walks_to_edges_; }

  /// The way below a surface is no edge of the path: light that leaves it at an exit counts as light that the
  /// surface scatters.
  PathList emerge() {
    PathList vertices;
    for (const int i : std::exchange(below_, {})) {
      State& s = states_[i];
      Path& path = paths_[size_t(i)];
      if (!aureole::emerge(scene_, vertices_, i, path.wavelengths, path.samples, TransportMode::radiance,
                           s.vertex, s.density, s.flight))
        continue;
      if (log_.follows(i)) log_exit(log_, vertices_[i].point(), s.density.hero_symmetric_throughput());
      s.pairs = path.samples.directions(s.vertex);
      vertices.add(i);
    }
    return vertices;
  }

private:
  // These make other keys of one.
  static constexpr std::uint32_t kOther = 0x2545f491u, kAroundEdges = 0x7feb352du, kFromSensor = 0x846ca68bu;

  struct State : std::conditional_t<kAny, PathInSpace, PathInEmptySpace> {
    Flight flight;
    PathDensity density;  ///< up to and including the direction of `flight`
    LightReference
        from;       ///< of the vertex that `flight` left, where light sampling could have found what it meets
    int depth = 0;  ///< scattering events so far
    int vertex = -1;  ///< vertices before the present one, surfaces that were passed without scattering
                      ///< among them
    const float* pairs = nullptr;  ///< random numbers of the present vertex
    float eta2 = 1;     ///< squared index of the present medium over the camera's: undoes the n^2 of radiance
                        ///< for roulette
    bool last = false;  ///< the present surface may only be passed
  };

  void go_on(int i, const Vertex& vertex, const Vec3& d) { vertex.leave(d, has_media(), states_[i].flight); }
  bool has_media() const { return kAny && scene_.has_media(); }

  /// What edges beside the flight take of it, over that distance.
  void lend(int i, float t) requires kAny {
    State& s = states_[i];
    const Path& path = paths_[size_t(i)];
    lend_to_edges(scene_, s.flight.ray, t, s.after_edge.end(), path.wavelengths,
                  key(path.samples, s.vertex, Key::flight), s.density);
  }

  /// The part of the path's weight that is left.
  static float left(const State& s) {
    const float left = s.density.hero_symmetric_throughput() * s.eta2;
    if constexpr (kAny) return left / s.whole;
    return left;
  }

  /// Roulette; false where the path ends.
  bool survives(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    if (s.depth >= limits_.roulette_depth) {
      const float survival = std::min(PathLimits::most_survival(scene_, s.depth), left(s));
      if (!(get(path.samples, s.vertex, Choice::roulette) < survival)) return false;
      s.density.survive(survival);
    }
    // The last ray can only bring emission.
    return limits_.reaches(s.depth + 2) || (!has_looked(s) && scene_.may_meet_emitter(s.flight.ray));
  }
  static bool has_looked(const State& s) {
    if constexpr (kAny) return s.looked;
    return false;
  }

  bool may_walk_to_edge(const State& s, const Vertex& vertex) const {
    return walks_to_edges_ && vertex.is_smooth() && limits_.reaches(s.depth + 4);
  }
  /// The path leaves its vertex for an edge.
  [[gnu::noinline]] bool walk_to_edge(int i, EdgePaths& edges) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (s.depth == 0) paths_[size_t(i)].result.alpha = 1;
    Spectrum value;
    EdgePaths::AtEdge at;
    if (!edges.walk(vertex, s.flight, s.to_edge, value, at)) return false;
    ++s.depth;
    return go_on_from_edge(i, edges, at, value);
  }
  bool go_on_from_edge(int i, EdgePaths& edges, const EdgePaths::AtEdge& first, const Spectrum& value) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    const auto see = [&](const EdgePaths::AtEdge& at, const Spectrum& so_far) {
      if (log_.follows(i)) log_edge(log_, s.depth, at.point.p);
      const auto kernel = [&](const Vec3& d) { return edges.kernel(at, d); };
      path.result.estimate += s.density.contribution(
          so_far * edges.from_light(at.place(), EdgePaths::Beside::nothing, 1, kernel), path.wavelengths);
    };
    if (!edges.leave(
            first, value, s.depth, [&](int n) { return limits_.reaches(n); }, see, s.density, s.flight,
            s.after_edge))
      return false;
    s.looked = true;
    ++s.vertex;
    return survives(i);
  }

  /// Where connections cannot find what shines through a medium (from the sensor, after a mirror) walks would see it
  /// or not: a line of sight brings what passes, without chance, and walks nothing. Begins where the ray first comes
  /// into a medium. Only towards lamps: the sky is about as bright as what fog before it scatters, and of two such
  /// numbers one by chance has less noise than a sum of which one part is by chance.
  void look_ahead(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if (s.looked || s.density.has_light_ratio() || (limits_.hide_emitters && s.depth == 0)) return;
    if (!scene_.may_meet_shining_shape(s.flight.ray)) return;
    s.looked = true;
    s.looked_from = s.density;
    sight_->begin(i, s.flight, 1.f, key(paths_[size_t(i)].samples, s.vertex, Key::flight) ^ kOther);
    if (sight_->arrive(i, hit) == Event::crossed) lines_.add(i, sight_->ray(i));
  }

  /// Through the medium along the ray: `medium` where the path is scattered there, `crossed` where it arrives
  /// at the distance t_max.
  [[gnu::noinline]] Event fly(int i, float t_max) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    const std::optional<Equiangular> places = connect_segment(i, t_max);
    Vec3 p;
    Spectrum chosen;
    if (!aureole::fly(s.flight, t_max, path.wavelengths, path.samples, s.vertex, s.density,
                      s.looked ? nullptr : &path.result.estimate, p, {media_, s.from, s.share}, &chosen))
      return Event::crossed;
    s.by_light = places ? chosen * places->pdf(dot(p - s.flight.ray.o, s.flight.ray.d)) : Spectrum(0.f);
    lend(i, length(p - s.flight.ray.o));
    if (log_.follows(i))
      log_medium(log_, s.depth, p, *s.flight.medium, s.density.hero_symmetric_throughput());
    if (s.depth == 0) path.result.alpha = 1;
    if (!limits_.reaches(s.depth + 2) || s.in_media == limits_.max_scattering || s.density.beta.is_black())
      return Event::blocked;
    if (s.after_edge.is_set && !s.after_edge.leaves_beam(scene_, p, path.wavelengths, s.density))
      return Event::blocked;
    ++s.in_media;
    s.last = false;
    s.pairs = path.samples.directions(++s.vertex);
    vertices_.make(i, [&] { return Vertex({p, s.flight.medium}, -s.flight.ray.d, path.wavelengths); });
    return Event::medium;
  }

  /// Whether lights may choose places along the flight in the medium.
  bool may_choose_places(const State& s) const {
    constexpr int kLatest = 8;  // scattered more often, light is all around
    return lights_choose_places_ && s.depth < kLatest && scene_.lights_reach(*s.flight.medium);
  }

  /// Connects a place along the flight, whichever the flight itself will choose, where a light is near. From there
  /// connections look for no emission, whose weights do not count this technique (`share`).
  std::optional<Equiangular> connect_segment(int i, float t_max) {
    const State& s = states_[i];
    Path& path = paths_[size_t(i)];
    if (!may_choose_places(s) || !limits_.reaches(s.depth + 2) || s.in_media == limits_.max_scattering ||
        s.density.beta.is_black())
      return {};
    // The numbers of the vertex that the flight may lead to: what the two bring adds up.
    const std::uint32_t random = key(path.samples, s.vertex + 1, Key::connection) ^ kOther;
    const auto places =
        places_by_light(scene_, s.flight, t_max, path.wavelengths, KeyedRandom(random).next());
    if (!places) return {};
    const float* pairs = path.samples.directions(s.vertex + 1);
    if (connect_along(scene_, s.flight, s.density, *places, get(path.samples, s.vertex, Choice::distance),
                      get(path.samples, s.vertex + 1, Choice::light), get(pairs, Pair::connection),
                      path.wavelengths, random + 1, segments_->of_path[i]))
      segments_->rays.add(i, segments_->of_path[i].flight.ray);
    return places;
  }

  Event escape(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    if (log_.follows(i)) log_escape(log_, s.depth, s.flight.ray.d);
    if (s.depth == 0) {
      path.result.alpha = limits_.hide_emitters || scene_.infinite_emitters().empty() ? 0.f : 1.f;
      if (limits_.hide_emitters) return Event::escape;
    }
    for (const Light* light : scene_.infinite_emitters())
      add_emission(i, *light, nullptr, light->eval_escaped(s.flight.ray.d, path.wavelengths));
    return Event::escape;
  }

  void add_emission(int i, const Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    const State& s = states_[i];
    if (has_looked(s) || is_black(radiance)) return;
    Path& path = paths_[size_t(i)];
    path.result.estimate +=
        s.density.has_light_ratio()
            ? s.density.met(radiance, light_density(scene_, s.from, light, point, s.flight.ray.d),
                            path.wavelengths)
            : s.density.contribution(radiance, path.wavelengths);
  }

  const Scene& scene_;
  const EmittingMedia* media_;       ///< those that connections look for, or null
  const bool lights_choose_places_;  ///< along flights in media
  const bool walks_to_edges_;
  const PathLimits& limits_;
  std::span<Path> paths_;
  const BatchLog& log_;
  State states_[kBatch];
  PerPath<Vertex> vertices_;
  PathList below_;  ///< that have gone on below a surface
  BatchConnections* segments_ = nullptr;
  std::optional<SightSteps<PathSteps>> sight_;  ///< in scenes with media
  BatchRays lines_;                             ///< of it
};

class PathIntegrator final : public Integrator {
public:
  explicit PathIntegrator(const Properties& p)
      : Integrator(p), limits_(p), diffraction_(get_diffraction(p)) {}

  SceneNeeds needs() const override { return {diffraction_}; }
  Leaves leaves() const override { return diffraction_ ? Leaves::both : Leaves::pixel; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }
  bool shows_emitters() const override { return limits_.reaches(1) && !limits_.hide_emitters; }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    for (Path& p : paths) p.result = {};
    if (!limits_.reaches(1)) return;
    if (scene.has_media() || scene.edges())
      follow_from_sensor<Space::any>(scene, paths, log);
    else
      follow_from_sensor<Space::empty>(scene, paths, log);
    if (scene.edges() && !scene.edges()->empty()) look_at_edges(scene, paths, splats, log);
  }

private:
  template <Space kSpace>
  void follow_from_sensor(const Scene& scene, std::span<Path> paths, const BatchLog& log) const {
    PathSteps<kSpace> steps(scene, limits_, paths, log);
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i) rays.add(int(i), paths[i].ray);
    follow(scene, steps, rays, RayTracer::Rays::coherent);
  }

  /// The light that the sensor sees come from edges, wherever they are on the film: one path to a light around one edge, and one
  /// that goes on from an edge, per sample.
  [[gnu::noinline]] void look_at_edges(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                                       const BatchLog& log) const {
    if (!limits_.reaches(2)) return;
    std::array<Path, kBatch> seen;
    std::array<Vec2, kBatch> film;
    for (size_t i = 0; i < paths.size(); ++i) {
      seen[i] = paths[i];
      seen[i].samples = paths[i].samples.of_second_path();
      seen[i].result = {};
    }
    const std::span<Path> from_edges(seen.data(), paths.size());
    PathSteps<Space::any> steps(scene, limits_, from_edges, log);
    BatchRays rays;
    for (size_t i = 0; i < paths.size(); ++i) {
      if (const auto splat = light_seen_around_edge(scene, int(i), paths[i], limits_.hide_emitters))
        splats.push_back(*splat);
      film[i] = {-1, -1};
      if (steps.begin_at_edge(int(i), film[i])) rays.add(int(i), steps.ray(int(i)));
    }
    follow(scene, steps, rays, RayTracer::Rays::incoherent);
    for (size_t i = 0; i < paths.size(); ++i)
      if (!is_black(seen[i].result.estimate)) splats.push_back({int(i), film[i], seen[i].result.estimate});
  }

  PathLimits limits_;
  std::optional<BeamWidth> diffraction_;
};

AUREOLE_PLUGIN(
    PathIntegrator, "integrator", "path",
    PluginDoc{
        "Path tracer: next-event estimation and BSDF sampling combined by spectral multiple importance "
        "sampling.",
        "Kajiya 1986; Veach 1997, chapters 9 and 10; Wilkie et al. 2014, Eq. 8",
        with_diffraction_parameters(
            {{"max_depth", "integer", "", "-1",
              "longest path in edges: 1 shows emitters only, 2 direct light; -1: no limit"},
             {"rr_depth", "integer", "", "5",
              "Russian roulette begins after this many vertices, 1000 at most"},
             {"max_scattering", "integer", "", "-1",
              "paths that media scatter more often do not count: 1 is single scattering; -1: no limit"},
             {"hide_emitters", "boolean", "", "false",
              "camera rays pass through area emitters and see no environment"}}),
        {R"(<integrator type="path"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/></integrator>)",
         R"(<integrator type="path"><boolean name="diffraction" value="true"/><string name="beam_width" value="50 wavelengths"/></integrator>)"}});

}  // namespace
}  // namespace aureole
