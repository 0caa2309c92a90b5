// SPDX-License-Identifier: Apache-2.0
// Subpaths of `bdpt` from the emitters.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "aureole/integrator/bdpt/subpath.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/driver.h"

namespace aureole::bdpt {

/// Paths from the emitters, and their connections with the sensor.
class LightSteps {
public:
  LightSteps(const Scene& scene, const Settings& settings, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log)
      : scene_(scene),
        limits_(settings.limits),
        techniques_(settings.techniques),
        paths_(paths),
        splats_(splats),
        log_(log),
        walks_to_edges_(finds_edges(scene)) {}

  const Ray& ray(int path) const { return states_[path].flight.ray; }
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  bool needs_march() const { return !scene_.has_binary_visibility() || limits_.hide_emitters; }
  std::uint32_t connection_key(int i) const {
    return key(states_[i].samples, states_[i].vertex, Key::connection);
  }
  /// The last vertex of a path that may be connected, from which `previous` leads to the others.
  const LightVertex* last_vertex(int path) const { return states_[path].kept; }

  /// Whether paths of light may find edges that those of the sensor do not.
  static bool finds_edges(const Scene& scene) {
    return scene.edges() && !scene.edges()->empty() && scene.edges()->has_mirrors();
  }

  /// Where the path begins; false where it carries no light.
  bool emit(int i) {
    Path& path = paths_[size_t(i)];
    State& s = states_[i];
    s.samples = path.samples.of_second_path();
    const std::optional<LightChoice> choice =
        scene_.lights().choose_by_power(s.samples.get2(SampleStream::choice(0, int(Choice::light))));
    if (!choice) return false;
    const auto emitted = choice->light->sample_ray(choice->part, get(s.samples, 0, Pair::connection),
                                                   get(s.samples, 0, Pair::scatter), path.wavelengths);
    if (!emitted || is_black(emitted->value)) return false;
    const float pdf = choice->probability * emitted->pdf_position * emitted->pdf_direction;
    if (!(pdf > 0)) return false;
    s.emission = {*choice, *emitted};
    s.density.beta = Weight(emitted->value);
    s.density.survive(pdf);
    s.whole = s.density.hero_symmetric_throughput();
    // Other techniques find the emitter by its solid angle as seen from the first vertex: one vertex has the cosine
    // of this.
    const float cosine = choice->light->shape ? std::abs(dot(emitted->ng, emitted->d)) : 1.f;
    s.density.earlier = choice->light->is_delta() ? 0.f : cosine / pdf;
    s.density.light_ratio = cosine / pdf;
    s.from = emitted->p;
    s.flight.ray = Anchor::of(*emitted).leave(emitted->d);
    find_surroundings(scene_, choice->light, s.flight);
    if (log_.follows(i)) log_emitter(log_, *choice->light, choice->part, s.flight.ray);
    return true;
  }

  /// Begins a path at an edge that a lamp shines on, instead of a ray of the lamp; false where there is none. `others`: the last
  /// vertex of another path of light, to which those of this one are added.
  bool begin_at_edge(int i, const LightVertex* others) {
    Path& path = paths_[size_t(i)];
    State& s = states_[i];
    s.kept = others;
    s.samples = path.samples.of_second_path().of_second_path();
    EdgePaths edges(scene_, path.wavelengths, key(s.samples, 0, Key::connection) ^ kFromEnd);
    Spectrum value = 1.f;
    EdgePaths::AtEdge at;
    if (!limits_.reaches(4) || !edges.begin_at_light(value, at)) return false;
    s.whole = max_component(abs(value));
    return go_on_from_edge(i, edges, at, value);
  }

  Event arrive(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    const Path& path = paths_[size_t(i)];
    if (s.flight.medium) {
      const Event event = fly(i, hit ? hit.t : kInfinity);
      if (event != Event::crossed) return event;
    }
    if (!hit) return Event::escape;
    lend(i, hit.t);
    s.present = &vertices_.make(scene_, hit, s.flight, path.wavelengths, TransportMode::importance);
    Vertex& vertex = s.present->vertex;
    ++s.vertex;
    if (s.flight.is_hidden(vertex.surface())) {
      vertex.leave(s.flight.ray.d, scene_.has_media(), s.flight);
      return Event::crossed;
    }
    if (s.after_edge.is_set && !vertex.is_passable() &&
        !s.after_edge.leaves_beam(scene_, vertex.p(), path.wavelengths, s.density))
      return Event::blocked;
    vertex.prepare(vertex.surface().needs_choice ? key(s.samples, s.vertex) : 0, s.flight);
    if (log_.follows(i))
      log_surface(log_, s.scattered + 1, vertex.point(), s.density.hero_symmetric_throughput() / s.whole);
    arrived(i);
    return Event::surface;
  }

  void lose(int i) { paths_[size_t(i)].result.invalidate(); }

  bool connect(int i, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = s.present->vertex;
    if (!vertex.is_smooth() || s.edges == Edges::of_sensor || !techniques_.have(s.scattered + 2, 1))
      return false;
    // Rays of the sensor pass through the surfaces of emitters.
    if (limits_.hide_emitters && vertex.light()) return false;
    const Path& path = paths_[size_t(i)];
    const Vec2 lens = scene_.sensor().uses_lens() ? get(s.samples, s.vertex, Pair::connection) : Vec2{};
    const auto seen = scene_.sensor().sample_direct(vertex.p(), lens);
    if (!seen || !(seen->importance > 0)) return false;
    if (!vertex.is_surface() && !scene_.may_see(*s.flight.medium, seen->p)) return false;
    const auto inverse = scene_.sensor().eval(vertex.p(), -seen->wo, seen->film);
    Response response;
    if (!inverse || !vertex.respond(seen->wo, response)) return false;
    const Spectrum other = techniques_.others(inverse->pdf_across * vertex.density_across(seen->wo) *
                                              s.arrived.others(vertex.reverse_pdf(seen->wo)));
    out.set(vertex.anchor(), seen->wo, Anchor::in_space(seen->p));
    out.through_emitters = limits_.hide_emitters;
    out.light = response.value.after(s.arrived.beta).of(Spectrum(seen->importance));
    weigh(scene_, s.arrived.ratio, other, path.wavelengths, out);
    if (scene_.has_media())
      out.begin_in(vertex.surroundings(seen->wo, s.flight), key(s.samples, s.vertex, Key::connection));
    film_[i] = seen->film;
    return true;
  }

  void connected(int i, const Connection& c, bool open) {
    if (open) splats_.push_back({i, film_[i], c.light});
    if (log_.follows(i)) log_seen(log_, film_[i], c, open);
  }

  bool scatter(int i) {
    State& s = states_[i];
    const Vertex& vertex = s.present->vertex;
    const float to_edge = walks_to_edges_ && vertex.is_smooth() && limits_.reaches(s.scattered + 5)
                              ? EdgePaths::to_edge(scene_, vertex.p(), paths_[size_t(i)].wavelengths)
                              : 0;
    if (to_edge > 0) {
      KeyedRandom random(key(s.samples, s.vertex, Key::connection) ^ kAroundEdges);
      if (random.next() < to_edge) return walk_to_edge(i, random, to_edge);
    }
    const bool last = !limits_.reaches(s.scattered + 3);
    if (last && !vertex.is_passable()) return false;
    const float lobe = vertex.needs_choice() ? get(s.samples, s.vertex, Choice::lobe) : 0.f;
    Scatter b;
    const Event event = vertex.scatter(lobe, get(s.samples, s.vertex, Pair::scatter), b);
    if (event == Event::blocked) return false;
    if (event == Event::crossed) {
      s.density.attenuate(b.value);
      if (to_edge > 0) s.density.survive(1 - to_edge);
      vertex.leave(b.d, scene_.has_media(), s.flight);
      return true;
    }
    if (last || b.value.is_black()) return false;
    s.after_edge.is_set = false;
    if (s.leaves_edge) s.edges = b.delta ? Edges::of_emitter : Edges::of_sensor;
    s.leaves_edge = false;
    s.density = s.arrived;
    s.density.scatter(b, vertex.reverse_pdf(b), vertex.density_across(b.d));
    // Like roulette, a choice that no weight knows.
    if (to_edge > 0) s.density.survive(1 - to_edge);
    s.from = vertex.p();
    vertex.leave(b.d, scene_.has_media(), s.flight);
    ++s.scattered;
    return survives(i);
  }

private:
  /// Which end finds the edges of the path so far. Those of the sensor may still become those of the emitter, behind a later edge.
  enum class Edges : std::uint8_t { of_emitter, of_sensor };

  struct State : Subpath<PathStart::emitter> {
    SampleStream samples;
    Emission emission;
    LightVertex* present = nullptr;
    const LightVertex* kept = nullptr;  ///< the last one that may be connected
    Edges edges = Edges::of_emitter;
    bool leaves_edge = false;  ///< the vertex before is an edge
  };

  bool survives(int i) {
    State& s = states_[i];
    if (s.scattered < limits_.roulette_depth) return true;
    const float survival =
        std::min(PathLimits::most_survival(scene_, 0), s.density.hero_symmetric_throughput() / s.whole);
    if (!(get(s.samples, s.vertex, Choice::roulette) < survival)) return false;
    s.density.survive(survival);
    return true;
  }

  [[gnu::noinline]] bool walk_to_edge(int i, const KeyedRandom& random, float probability) {
    State& s = states_[i];
    EdgePaths edges(scene_, paths_[size_t(i)].wavelengths, random);
    Spectrum value;
    EdgePaths::AtEdge at;
    s.density = s.arrived;
    if (!edges.walk(s.present->vertex, s.flight, probability, value, at)) return false;
    ++s.scattered;
    return go_on_from_edge(i, edges, at, value);
  }
  bool go_on_from_edge(int i, EdgePaths& edges, const EdgePaths::AtEdge& first, const Spectrum& value) {
    State& s = states_[i];
    const auto log = [&](const EdgePaths::AtEdge& at, const Spectrum&) {
      if (log_.follows(i)) log_edge(log_, s.scattered + 1, at.point.p);
    };
    if (!edges.leave(
            first, value, s.scattered, [&](int n) { return limits_.reaches(n); }, log, s.density, s.flight,
            s.after_edge))
      return false;
    s.density.leave_edge(s.after_edge.pdf, false);
    s.from = s.after_edge.edge;
    s.edges = Edges::of_sensor, s.leaves_edge = true;
    ++s.vertex;
    return survives(i);
  }

  /// As that of `ptracer`.
  void lend(int i, float t) {
    State& s = states_[i];
    lend_to_edges(scene_, s.flight.ray, t, s.after_edge.end(), wavelengths(i),
                  key(s.samples, s.vertex, Key::flight), s.density);
  }

  [[gnu::noinline]] Event fly(int i, float t_max) {
    State& s = states_[i];
    const Path& path = paths_[size_t(i)];
    Vec3 p;
    if (!aureole::fly(s.flight, t_max, path.wavelengths, s.samples, s.vertex, s.density, nullptr, p))
      return Event::crossed;
    lend(i, length(p - s.flight.ray.o));
    if (log_.follows(i))
      log_medium(log_, s.scattered + 1, p, *s.flight.medium, s.density.hero_symmetric_throughput() / s.whole);
    if (s.in_media == limits_.max_scattering || s.density.beta.is_black()) return Event::blocked;
    if (s.after_edge.is_set && !s.after_edge.leaves_beam(scene_, p, path.wavelengths, s.density))
      return Event::blocked;
    ++s.in_media, ++s.vertex;
    s.present = &vertices_.make(MediumPoint{p, s.flight.medium}, -s.flight.ray.d, path.wavelengths);
    arrived(i);
    return Event::medium;
  }

  /// At a vertex: its densities. Keeps it for connections.
  void arrived(int i) {
    State& s = states_[i];
    LightVertex& present = *s.present;
    const Vertex& vertex = present.vertex;
    s.arrived = s.density;
    const Vec3 d = s.flight.ray.d;
    float spread = length_squared(vertex.p() - s.from);
    if (s.scattered == 0) {
      // The density of the connection is per solid angle already, but for that with a point.
      spread = s.emission.connection_density(scene_, {vertex.p(), vertex.facing()}) *
               (s.emission.ray.delta_position ? spread : 1.f);
    }
    s.arrived.arrive(!vertex.is_surface(), vertex.density_across(d), spread);
    if (!vertex.is_smooth() || s.edges == Edges::of_sensor) return;
    present.density = s.arrived;
    present.edges = s.scattered + 1, present.in_media = s.in_media;
    present.previous = s.kept;
    s.kept = &present;
  }

  const Scene& scene_;
  const PathLimits& limits_;
  const Techniques& techniques_;
  std::span<Path> paths_;
  std::vector<Splat>& splats_;
  const BatchLog& log_;
  const bool walks_to_edges_;
  State states_[kBatch];
  LightVertices vertices_;
  Vec2 film_[kBatch];  ///< where a connection's light falls
};

}  // namespace aureole::bdpt
