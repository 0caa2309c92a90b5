// SPDX-License-Identifier: Apache-2.0
// Subpaths of `bdpt` from the sensor, with their connections to emitters and to the paths of light.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "aureole/core/random.h"
#include "aureole/integrator/bdpt/subpath.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/driver.h"

namespace aureole::bdpt {

class SensorSteps {
public:
  SensorSteps(const Scene& scene, const Settings& settings, std::span<Path> paths, const BatchLog& log)
      : scene_(scene),
        limits_(settings.limits),
        techniques_(settings.techniques),
        paths_(paths),
        log_(log),
        walks_to_edges_(scene.edges() && !scene.edges()->empty()) {
    for (size_t i = 0; i < paths.size(); ++i) {
      State& s = states_[i];
      s.flight.ray = paths[i].ray;
      s.density.light_ratio = 1.f;  // `arrived` asks the sensor
      s.vertex = -1;
      find_surroundings(scene, nullptr, s.flight);
    }
  }

  /// The last vertex of the path of light to whose vertices edges of this path are connected, or null.
  void put_light(int path, const LightVertex* last) { states_[path].light = last; }
  /// Begins a path at an edge that the sensor sees at `film`, instead of the sensor's ray; false where there is none.
  bool begin_at_edge(int i, Vec2& film) {
    const Path& path = paths_[size_t(i)];
    State& s = states_[i];
    if (!limits_.reaches(3)) return false;
    EdgePaths edges(scene_, path.wavelengths, key(path.samples, 0, Key::connection) ^ kFromEnd,
                    limits_.hide_emitters);
    const Vec2 lens = edges.next2();
    Spectrum value = 1.f;
    EdgePaths::AtEdge at;
    if (!edges.begin_at_sensor(lens, value, at, film)) return false;
    s.density = {};
    s.whole = max_component(abs(value));
    return go_on_from_edge(i, edges, at, value);
  }

  const Ray& ray(int path) const { return states_[path].flight.ray; }
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  bool needs_march() const { return !scene_.has_binary_visibility(); }
  std::uint32_t connection_key(int i) const {
    return key(paths_[size_t(i)].samples, states_[i].vertex, Key::connection);
  }

  Event arrive(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if (s.flight.medium) {
      const Event event = fly(i, hit ? hit.t : kInfinity);
      if (event != Event::crossed) return event;
    }
    lend(i, hit ? hit.t : kInfinity);
    if (!hit) return escape(i);
    Path& path = paths_[size_t(i)];
    Vertex& vertex = vertices_.make(
        i, [&] { return Vertex(scene_, hit, s.flight, path.wavelengths, TransportMode::radiance); });
    if (log_.follows(i))
      log_surface(log_, s.scattered, vertex.point(), s.density.hero_symmetric_throughput());
    if (s.flight.is_hidden(vertex.surface())) {
      ++s.vertex;  // the flight behind has random numbers of its own
      go_on(i, s.flight.ray.d);
      return Event::crossed;
    }
    if (const Light* light = vertex.light()) {
      if (limits_.hide_emitters && s.scattered == 0) {
        s.vertex += scene_.has_media();  // the flight behind has random numbers of its own
        go_on(i, s.flight.ray.d);
        return Event::crossed;
      }
      add_emission(i, *light, &vertex.point(),
                   light->eval(vertex.point(), -s.flight.ray.d, path.wavelengths));
    }
    s.last = !limits_.reaches(s.scattered + 2);
    if (s.last && !vertex.surface().passable) {
      if (s.scattered == 0) path.result.alpha = 1;
      return Event::blocked;
    }
    if (s.after_edge.is_set && !vertex.is_passable() &&
        !s.after_edge.leaves_beam(scene_, vertex.p(), path.wavelengths, s.density))
      return Event::blocked;
    s.pairs = path.samples.directions(++s.vertex);
    vertex.prepare(vertex.surface().needs_choice ? key(path.samples, s.vertex) : 0, s.flight);
    arrived(i);
    return Event::surface;
  }

  void lose(int i) { paths_[size_t(i)].result.invalidate(); }

  /// Whether connections are possible at the vertex of the path.
  bool is_connectable(int i) { return !states_[i].last && vertices_[i].is_smooth(); }

  /// With a light.
  bool connect(int i, Connection& out) {
    State& s = states_[i];
    s.is_lit = false;
    const Vertex& vertex = vertices_[i];
    if (!is_connectable(i) || scene_.lights().empty() || !techniques_.have(1, s.scattered + 2)) return false;
    if (!vertex.is_surface() && !scene_.lights_reach(*s.flight.medium)) return false;
    Path& path = paths_[size_t(i)];
    const Vec3 facing = vertex.facing();
    const auto choice = scene_.lights().choose(
        vertex.p(), facing, scene_.lights().is_single() ? 0.f : get(path.samples, s.vertex, Choice::light));
    if (!choice || !(choice->probability > 0)) return false;
    const auto direct = choice->light->sample_direct_facing(vertex.p(), facing, choice->part,
                                                            get(s.pairs, Pair::connection), path.wavelengths);
    if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) return false;
    Response response;
    if (!vertex.respond(direct->wo, response)) return false;

    SurfacePoint emitting;
    emitting.p = direct->p, emitting.ng = direct->ng;
    // The density of a path of light to the vertex, its place on the emitter per solid angle as seen from here.
    float emission = emission_density(scene_, *choice->light, choice->part,
                                      choice->light->shape ? &emitting : nullptr, -direct->wo);
    if (choice->light->shape)
      emission *= safe_inverse(std::abs(dot(direct->ng, direct->wo)));
    else if (!direct->infinite)
      emission *= safe_inverse(length_squared(direct->p - vertex.p()));
    Spectrum other =
        s.arrived.others(vertex.reverse_pdf(direct->wo)) * vertex.density_across(direct->wo) * emission;
    if (!direct->delta) other += s.arrived.ratio * response.pdf;
    if (direct->infinite)
      out.set(vertex.anchor().leave(direct->wo));
    else
      out.set(vertex.anchor(), direct->wo, Anchor::of(*direct));
    out.light = s.arrived.beta.of(response.value.of(direct->radiance));
    weigh(scene_, s.arrived.ratio * (choice->probability * direct->pdf), techniques_.others(other),
          path.wavelengths, out);
    begin_in_media(i, vertex, direct->wo, key(path.samples, s.vertex, Key::connection), out);
    return true;
  }

  /// With a vertex of a path of light.
  bool connect(int i, const LightVertex& end, Connection& out) {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!limits_.reaches(s.scattered + 2 + end.edges) || !techniques_.have(end.edges + 1, s.scattered + 2))
      return false;
    if (limits_.max_scattering >= 0 && s.in_media + end.in_media > limits_.max_scattering) return false;
    if (!vertex.is_surface() && !scene_.may_see(*s.flight.medium, end.vertex.p())) return false;
    const Vec3 to = end.vertex.p() - vertex.p();
    const float distance2 = length_squared(to);
    if (!(distance2 > 0)) return false;
    const Vec3 d = to * (1 / std::sqrt(distance2));
    Response here, there;
    if (!vertex.respond(d, here) || !end.vertex.respond(-d, there)) return false;
    const Path& path = paths_[size_t(i)];
    const float inverse = 1 / distance2;
    const Spectrum from_here = s.arrived.ratio * here.pdf * end.vertex.density_across(d) *
                               end.density.others(end.vertex.reverse_pdf(-d)),
                   from_there = end.density.ratio * there.pdf * vertex.density_across(d) *
                                s.arrived.others(vertex.reverse_pdf(d));
    out.set(vertex.anchor(), d, end.vertex.anchor());
    out.light = s.arrived.beta.of(here.value.of(there.value.after(end.density.beta).of(Spectrum(inverse))));
    weigh(scene_, s.arrived.ratio * end.density.ratio, techniques_.others((from_here + from_there) * inverse),
          path.wavelengths, out);
    begin_in_media(
        i, vertex, d,
        std::uint32_t(combine_bits(key(path.samples, s.vertex, Key::connection), std::uint64_t(end.edges))),
        out);
    return true;
  }

  void connected(int i, const Connection& c, bool open) {
    if (open) paths_[size_t(i)].result.estimate += c.light;
    states_[i].is_lit |= open;
    if (log_.follows(i))
      log_(fmt::format("  connection: {} mean {:.6g}", open ? "visible" : "hidden", mean(c.light)));
  }

  /// Adds the light of lamps that reaches vertices around edges. To be called after connections with lights.
  void connect_around_edges(const PathList& vertices) {
    if (!walks_to_edges_) return;
    for (const int i : vertices) {
      const State& s = states_[i];
      const Vertex& vertex = vertices_[i];
      if (!is_connectable(i) || !limits_.reaches(s.scattered + 3) || !techniques_.have(1, s.scattered + 3))
        continue;
      Path& path = paths_[size_t(i)];
      EdgePaths edges(scene_, path.wavelengths, key(path.samples, s.vertex, Key::connection) ^ kToEdge);
      const Spectrum light =
          edges.from_light(EdgePaths::at_vertex(vertex, s.flight),
                           s.is_lit ? EdgePaths::Beside::direct : EdgePaths::Beside::surfaces,
                           s.arrived.hero_symmetric_throughput() * s.eta2 / s.whole,
                           [&](const Vec3& d) { return EdgePaths::response(vertex, d); });
      path.result.estimate += s.arrived.contribution(light, path.wavelengths);
      if (log_.follows(i) && !is_black(light))
        log_(fmt::format("  light around an edge: mean {:.6g}", mean(light)));
    }
  }

  bool scatter(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    const Vertex& vertex = vertices_[i];
    const float to_edge = walks_to_edges_ && vertex.is_smooth() && limits_.reaches(s.scattered + 4)
                              ? EdgePaths::to_edge(scene_, vertex.p(), path.wavelengths)
                              : 0;
    if (to_edge > 0) {
      KeyedRandom random(key(path.samples, s.vertex, Key::connection) ^ kAroundEdges);
      if (random.next() < to_edge) return walk_to_edge(i, random, to_edge);
    }
    const float lobe = vertex.needs_choice() ? get(path.samples, s.vertex, Choice::lobe) : 0.f;
    Scatter b;
    const Event event = vertex.scatter(lobe, get(s.pairs, Pair::scatter), b);
    if (event == Event::crossed) {
      s.density.attenuate(b.value);
      if (to_edge > 0) s.density.survive(1 - to_edge);
      go_on(i, b.d);
      return true;
    }
    if (s.scattered == 0) path.result.alpha = 1;
    if (event == Event::blocked || s.last) return false;
    s.looked = s.after_edge.is_set = false;
    s.density = s.arrived;
    s.density.scatter(b, vertex.reverse_pdf(b), vertex.density_across(b.d));
    // Like roulette, a choice that no weight knows.
    if (to_edge > 0) s.density.survive(1 - to_edge);
    s.from = vertex.p(), s.facing = vertex.facing();
    go_on(i, b.d);
    ++s.scattered;
    s.eta2 *= b.eta * b.eta;
    return survives(i);
  }

private:
  struct State : Subpath<PathStart::sensor> {
    Vec3 facing;                   ///< of the last vertex
    const float* pairs = nullptr;  ///< random numbers of the present vertex
    float eta2 = 1;     ///< squared index of the present medium over the sensor's: undoes the n^2 of radiance
                        ///< for roulette
    bool last = false;  ///< the present surface may only be passed
    /// The flight has left an edge: connections from before it have counted the lights that it meets.
    bool looked = false;
    bool is_lit = false;  ///< the vertex has light of the lamp that was asked
    const LightVertex* light = nullptr;
  };

  /// Roulette; false where the path ends.
  bool survives(int i) {
    State& s = states_[i];
    if (s.scattered >= limits_.roulette_depth) {
      const float survival = std::min(PathLimits::most_survival(scene_, 0),
                                      s.density.hero_symmetric_throughput() * s.eta2 / s.whole);
      if (!(get(paths_[size_t(i)].samples, s.vertex, Choice::roulette) < survival)) return false;
      s.density.survive(survival);
    }
    // The last ray can only bring emission.
    return limits_.reaches(s.scattered + 2) || (scene_.may_meet_emitter(s.flight.ray) && !s.looked);
  }

  /// The path leaves its vertex for an edge.
  [[gnu::noinline]] bool walk_to_edge(int i, const KeyedRandom& random, float probability) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    if (s.scattered == 0) path.result.alpha = 1;
    EdgePaths edges(scene_, path.wavelengths, random);
    Spectrum value;
    EdgePaths::AtEdge at;
    s.density = s.arrived;
    if (!edges.walk(vertices_[i], s.flight, probability, value, at)) return false;
    ++s.scattered;
    return go_on_from_edge(i, edges, at, value);
  }
  bool go_on_from_edge(int i, EdgePaths& edges, const EdgePaths::AtEdge& first, const Spectrum& value) {
    State& s = states_[i];
    const auto connect = [&](const EdgePaths::AtEdge& at, const Spectrum& so_far) {
      if (log_.follows(i)) log_edge(log_, s.scattered, at.point.p);
      if (techniques_.have(1, s.scattered + 3)) {
        const auto kernel = [&](const Vec3& d) { return edges.kernel(at, d); };
        Path& path = paths_[size_t(i)];
        path.result.estimate += s.density.contribution(
            so_far * edges.from_light(at.place(), EdgePaths::Beside::nothing, 1, kernel), path.wavelengths);
      }
      for (const LightVertex* end = s.light; end; end = end->previous)
        connect_edge(i, edges, at, so_far, *end);
    };
    if (!edges.leave(
            first, value, s.scattered, [&](int n) { return limits_.reaches(n); }, connect, s.density,
            s.flight, s.after_edge))
      return false;
    s.density.leave_edge(s.after_edge.pdf, true);
    s.from = s.after_edge.edge;
    s.looked = true;
    ++s.vertex;
    return survives(i);
  }

  /// An edge that the path has come to with the factor `value`, with a vertex of a path of light.
  void connect_edge(int i, EdgePaths& edges, const EdgePaths::AtEdge& at, const Spectrum& value,
                    const LightVertex& end) {
    const State& s = states_[i];
    if (!limits_.reaches(s.scattered + 2 + end.edges) || !techniques_.have(end.edges + 1, s.scattered + 2))
      return;
    if (limits_.max_scattering >= 0 && s.in_media + end.in_media > limits_.max_scattering) return;
    const float distance2 = length_squared(end.vertex.p() - at.point.on_edge());
    if (!(distance2 > 0)) return;
    const Vec3 d = -at.point.direction_from(end.vertex.p());
    if (!SceneEdges::turns_around(at.point, at.d, d)) return;
    Response there;
    if (!end.vertex.respond(-d, there)) return;
    Path& path = paths_[size_t(i)];
    const Anchor edge = Anchor::in_space(at.point.p);
    Connection c;
    c.set(edge, normalize(end.vertex.p() - edge.p), end.vertex.anchor());
    const float inverse = 1 / distance2;
    // Paths of light do not find this edge: beside the connection there is the walk of the sensor's path, and what is behind.
    const Spectrum other = s.density.ratio * end.vertex.density_across(d) *
                           end.density.others(end.vertex.reverse_pdf(-d)) *
                           (edges.scatter_pdf(at, d) * inverse);
    c.light = 1.f;
    weigh(scene_, s.density.ratio * end.density.ratio, techniques_.others(other), path.wavelengths, c);
    if (scene_.has_media())
      c.begin_in(at.flight, std::uint32_t(combine_bits(key(path.samples, s.vertex, Key::connection) ^ kToEdge,
                                                       std::uint64_t(end.edges))));
    if (!aureole::connect(scene_, c, path.wavelengths)) return;
    if (scene_.has_media()) c.finish();
    lend_to_edges(scene_, LightWay::of(c, LightWay::End::edge), path.wavelengths, connection_key(i), c.light);
    const Spectrum kernel = edges.kernel_to(at, d, end.vertex, std::sqrt(distance2));
    if (is_black(kernel)) return;
    path.result.estimate +=
        s.density.beta.of(value * kernel * there.value.after(end.density.beta).of(Spectrum(inverse))) *
        c.light;
    if (log_.follows(i)) log_(fmt::format("  connection of the edge: mean {:.6g}", mean(c.light * kernel)));
  }

  static float safe_inverse(float x) { return x > 0 ? 1 / x : 0.f; }

  void go_on(int i, const Vec3& d) { vertices_[i].leave(d, scene_.has_media(), states_[i].flight); }

  void begin_in_media(int i, const Vertex& vertex, const Vec3& d, std::uint32_t key, Connection& out) const {
    if (scene_.has_media()) out.begin_in(vertex.surroundings(d, states_[i].flight), key);
  }

  /// As that of `path`.
  void lend(int i, float t) {
    State& s = states_[i];
    lend_to_edges(scene_, s.flight.ray, t, s.after_edge.end(), wavelengths(i),
                  key(paths_[size_t(i)].samples, s.vertex, Key::flight), s.density);
  }

  /// As that of `path`.
  [[gnu::noinline]] Event fly(int i, float t_max) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    Spectrum* estimate = techniques_.have(0, s.scattered + 2) ? &path.result.estimate : nullptr;
    Vec3 p;
    if (!aureole::fly(s.flight, t_max, path.wavelengths, path.samples, s.vertex, s.density, estimate, p))
      return Event::crossed;
    lend(i, length(p - s.flight.ray.o));
    if (log_.follows(i))
      log_medium(log_, s.scattered, p, *s.flight.medium, s.density.hero_symmetric_throughput());
    if (s.scattered == 0) path.result.alpha = 1;
    if (!limits_.reaches(s.scattered + 2) || s.in_media == limits_.max_scattering ||
        s.density.beta.is_black())
      return Event::blocked;
    if (s.after_edge.is_set && !s.after_edge.leaves_beam(scene_, p, path.wavelengths, s.density))
      return Event::blocked;
    ++s.in_media;
    s.last = false;
    s.pairs = path.samples.directions(++s.vertex);
    vertices_.make(i, [&] { return Vertex({p, s.flight.medium}, -s.flight.ray.d, path.wavelengths); });
    arrived(i);
    return Event::medium;
  }

  /// At a vertex: its densities.
  void arrived(int i) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    const Vec3 d = s.flight.ray.d;
    float spread = length_squared(vertex.p() - s.from);
    if (s.scattered == 0) {
      const auto seen = scene_.sensor().eval(vertex.p(), d, paths_[size_t(i)].film);
      spread = seen ? safe_inverse(seen->pdf_across) : 0.f;
    }
    s.arrived = s.density;
    s.arrived.arrive(!vertex.is_surface(), vertex.density_across(d), spread);
  }

  Event escape(int i) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    if (log_.follows(i)) log_escape(log_, s.scattered, s.flight.ray.d);
    if (s.scattered == 0) {
      path.result.alpha = limits_.hide_emitters || scene_.infinite_emitters().empty() ? 0.f : 1.f;
      if (limits_.hide_emitters) return Event::escape;
    }
    for (const Light* light : scene_.infinite_emitters())
      add_emission(i, *light, nullptr, light->eval_escaped(s.flight.ray.d, path.wavelengths));
    return Event::escape;
  }

  /// The path has met an emitter: that is a path of light without a vertex.
  void add_emission(int i, const Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    const State& s = states_[i];
    if (s.looked || is_black(radiance) || !techniques_.have(0, s.scattered + 2)) return;
    Path& path = paths_[size_t(i)];
    Spectrum all = s.density.ratio;
    // No connection finds what the sensor sees directly.
    if (s.scattered > 0) {
      const Vec3& d = s.flight.ray.d;
      const std::size_t part = point ? light.part_of(*point) : 0;
      const float cosine = point ? std::abs(dot(point->ng, d)) : 1.f;
      all += techniques_.others(
          s.density.light_ratio * light_density(scene_, {s.from, s.facing}, light, part, point, d) +
          s.density.earlier * (emission_density(scene_, light, part, point, -d) * safe_inverse(cosine)));
    }
    path.result.estimate += s.density.beta.of(radiance) / (path.wavelengths.pdf * sum(all));
  }

  const Scene& scene_;
  const PathLimits& limits_;
  const Techniques& techniques_;
  std::span<Path> paths_;
  const BatchLog& log_;
  const bool walks_to_edges_;
  State states_[kBatch];
  PerPath<Vertex> vertices_;
};

}  // namespace aureole::bdpt
