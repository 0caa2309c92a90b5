// SPDX-License-Identifier: Apache-2.0
// `Walk`: the random walk of a batch of paths, from the sensor or from the lights. What a path does at every
// step is written here once; integrators derive from it and say what they connect with what.
//
// A step of the driver (transport/driver.h) has these phases, each over all paths of the batch:
//   locate   the ray through the medium that it is in, and the vertex that it leads to
//   emit     emission at the hit point; limits of the path's length
//   choose   the other end of a connection, such as a light: what the integrator's `choose` says
//   connect  next-event estimation from the vertex, by the response of its BSDF or phase function: what the
//            integrator's `connect` says; the driver traces the connection
//   scatter  the next direction, by the BSDF or the phase function; Russian roulette
//   emerge   exits of paths that were refracted into a surface with a BSSRDF (transport/emerge.h)
// Null surfaces and interfaces between media are crossed within these phases: they are no vertices.
//
// `Kind` of a walk names its parts:
//   L                    light and maps of light: Unpolarised (spectrum/weight.h)
//   Space kSpace         the scenes that it is compiled for
//   Density              throughput and pdfs: PathDensity, LightPathDensity, or TwoWayDensity of `bdpt`
//   State                further state of a path
//   Vertices             storage of the vertices of a batch, PerPath<Vertex> or one that keeps earlier vertices
//   bool kEmerges        whether paths continue below surfaces with a BSSRDF
//   bool kScattersInMedia   distance sampling in media; else paths pass media by their transmittance
// `Self` may replace these functions (hooks); the ones here do nothing or what most integrators do:
//   samples(i)                       the random numbers of the path
//   start(i)                         begins the path; false where it has none
//   emission(i, light, point, L)     the path has hit a light, or has left the scene towards a light at infinity
//                                    (point null)
//   emission_in_media(i)             receives the emission of media along the ray, or null
//   before_distance(i, hit)          the ray is in a medium and was traced
//   after_distance(i, p, chosen)     the path will be scattered in the medium at `p`
//   at_vertex(i)                     the path has arrived at a vertex
//   extend(i, scatter)               throughput and pdfs after scattering
//   scattered(i, scatter)            the path was scattered
//   follows_last(i)                  whether a light path samples a direction at its last vertex
//   may_cut_ray(i)                   whether the ray may be cut where the medium will scatter the path
//   connection_count(i)              upper bound of the number of connections of the vertex
//   choose(i, k)                     chooses the other end of the k-th one
//   connect(i, k, connection)        makes it; false where there is none
//   connected(i, k, connection, open)   receives its result
//   further_segments(i, k)           segments of the path beyond the k-th connection
//   has_technique(s, t)              whether paths of s vertices from the light and t from the sensor count
//   edge_samples()                   number of estimates of light that reaches a vertex around an edge
//   has_indirect_light()             whether such a vertex also has light by way of surfaces
#pragma once

#include <span>

#include "aureole/transport/dimensions.h"
#include "aureole/transport/driver.h"
#include "aureole/transport/edge_walk.h"
#include "aureole/transport/emerge.h"
#include "aureole/transport/next_event.h"
#include "aureole/transport/path.h"
#include "aureole/transport/path_limits.h"
#include "aureole/transport/path_log.h"
#include "aureole/transport/walk_state.h"

namespace aureole {

template <class Self, class Kind>
class Walk {
public:
  static constexpr bool kAny = Kind::kSpace == Space::any;
  static constexpr bool kFromSensor = Kind::Density::kBegin == PathStart::sensor;
  /// Edges diffract light (transport/edge_walk.h).
  static constexpr bool kDiffracts = kAny && std::is_same_v<typename Kind::L, Unpolarised>;
  /// Diffraction factors of segments are computed when the path adds light to the result. Paths whose throughput
  /// is used in other ways compute them at once.
  static constexpr bool kDefersDiffraction = false;
  static constexpr TransportMode kMode = kFromSensor ? TransportMode::radiance : TransportMode::importance;
  using L = typename Kind::L;
  using Vertex = BasicVertex<Kind::kSpace, L>;
  using Response = BasicResponse<L>;
  using Scatter = BasicScatter<L>;
  using Connection = BasicConnection<L>;
  using Density = typename Kind::Density;
  struct State : WalkState<Kind::kSpace, Density>, Kind::State {};

  explicit Walk(const WalkInput& in)
      : scene_(in.scene),
        limits_(in.limits),
        paths_(in.paths),
        log_(in.log),
        states_(in.arena.make<State>(in.paths.size()).data()),
        diffraction_(in.arena.make<WalkDiffraction>(kAny ? in.paths.size() : 0).data()),
        vertices_(in.arena, in.paths.size()),
        below_(in.arena, in.paths.size()),
        edges_(in.scene) {
    if (kAny && in.scene.has_contacts()) contacts_ = in.arena.make<Contact>(in.paths.size());
  }

  // Functions that the driver calls:
  const Ray& ray(int i) const { return states_[i].segment.ray; }
  const Wavelengths& wavelengths(int i) const { return paths_[size_t(i)].wavelengths; }
  bool needs_march() const {
    return !scene_.has_binary_visibility() || (!kFromSensor && limits_.hide_emitters);
  }
  std::uint32_t connection_key(int i) {
    return key(self().samples(i), states_[i].vertex, Stream::connection);
  }
  /// Number of surfaces that the k-th connection may cross, of those that count for the limit of segments.
  int crossings_left(int i, int k) { return crossings_beside(i, 2 + self().further_segments(i, k)); }
  /// Number of surfaces that the present ray may cross before a light, of those that count for the limit of
  /// segments.
  int crossings_before_light(int i) const { return crossings_beside(i, 1); }
  void lose(int i) { paths_[size_t(i)].result.invalidate(); }
  Event locate(int i, const RayTracer::Hit& hit);
  Event emit(int i);
  bool scatter(int i);
  void emerge(PathList& vertices) requires(Kind::kEmerges);
  void end_connection(int i, int k, Connection& c, bool open) {
    if constexpr (kDiffracts)
      if (open) c.passage *= edges_.count_pending(self(), i) * edges_.chain_factor(self(), i);
    if constexpr (kAny)
      if (k == 0) states_[i].is_connected = open;
    self().connected(i, k, c, open);
  }
  void connect_edges(const PathList& vertices) {
    if constexpr (kDiffracts) edges_.connect(self(), vertices);
  }

  // Functions that `EdgeWalk` calls:
  const Scene& scene() const { return scene_; }
  const PathLimits& limits() const { return limits_; }
  Path& path(int i) { return paths_[size_t(i)]; }
  const BatchLog& log() const { return log_; }
  State& state(int i) { return states_[i]; }
  WalkDiffraction& diffraction(int i) requires kAny { return diffraction_[i]; }
  Vertex& vertex(int i) { return vertices_[i]; }
  /// Throughput and pdfs at the present vertex.
  const Density& vertex_density(int i) const { return states_[i].density; }
  bool survives(int i);
  /// The path's throughput at the present vertex relative to that at its start, for Russian roulette.
  float relative_throughput(int i) const { return relative(i, self().vertex_density(i)); }
  /// Begins a path at an edge, which the sensor sees at `film` or a light irradiates; false where there is
  /// none.
  bool begin_at_edge(int i, Vec2& film) requires kDiffracts { return edges_.begin(self(), i, film); }

  void log_connection(const Connection& c, bool open, int vertex = 0, bool along_ray = false) const {
    log_({.kind = PathEvent::Kind::connection,
          .p = c.target,
          .d = c.d,
          .infinite = c.infinite,
          .vertex = vertex,
          .open = open,
          .along_ray = along_ray,
          .from = c.origin,
          .estimate = c.estimate()});
  }
  void log_emission(int i, const SurfacePoint* point, const Spectrum& estimate) const {
    log_({.kind = PathEvent::Kind::emission,
          .depth = states_[i].depth + 1,
          .p = point ? point->p : Vec3{},
          .d = states_[i].segment.ray.d,
          .infinite = !point,
          .estimate = estimate});
  }
  void log_sensor(const Connection& c, Vec2 film, bool open) const {
    log_({.kind = PathEvent::Kind::sensor,
          .p = c.target,
          .d = c.d,
          .open = open,
          .estimate = c.estimate(),
          .film = film});
  }

  // Hooks, which are described at the top of this file:
  SampleStream& samples(int i) { return paths_[size_t(i)].samples; }
  /// Adds emission weighted against light sampling at the vertex that the ray has left.
  void emission(int i, const Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    const State& s = states_[i];
    if (is_black(radiance)) return;
    if constexpr (kAny)
      if (s.emission_counted) return;
    const Wavelengths& w = wavelengths(i);
    const Spectrum estimate =
        s.density.has_light_ratio()
            ? s.density.met(radiance, light_density(scene_, s.from, light, point, s.segment.ray.d, w.time), w)
            : s.density.contribution(radiance, w);
    path(i).result.estimate += estimate;
    if (log_.follows(i)) log_emission(i, point, estimate);
  }
  Spectrum* emission_in_media(int) { return nullptr; }
  EmissionSampling emission_sampling(int) { return {}; }
  void before_distance(int, const RayTracer::Hit&) {}
  void after_distance(int, const Vec3&, const Spectrum&) {}
  void at_vertex(int) {}
  void extend(int i, const Scatter& b) { states_[i].density.extend(b.value, b.pdf, b.delta); }
  void scattered(int, const Scatter&) {}
  /// Number of segments that a path has beyond its k-th connection.
  int further_segments(int, int) const { return 0; }
  bool follows_last(int) const { return false; }
  bool may_cut_ray(int) const { return true; }
  int connection_count(int) const { return 1; }
  bool has_technique(int, int) const { return true; }
  int edge_samples() const { return 1; }
  bool has_indirect_light() const { return true; }

protected:
  Self& self() { return static_cast<Self&>(*this); }
  const Self& self() const { return static_cast<const Self&>(*this); }
  bool has_media() const { return kAny && scene_.has_media(); }
  /// Number of crossings that the limit still allows to a path with `further` more segments than scattering
  /// events.
  int crossings_beside(int i, int further) const {
    return limits_.crossings_left(states_[i].depth + states_[i].crossed + further);
  }
  /// Whether paths with `further` more segments than scattering events count.
  bool reaches(int i, int further) const {
    return limits_.reaches(states_[i].depth + states_[i].crossed + further);
  }
  /// The path goes on along `d`: `begins` a new segment at a vertex, else it has crossed a surface.
  void go_on(int i, const Vertex& vertex, const Vec3& d, bool begins) {
    Segment& segment = states_[i].segment;
    vertex.leave(d, has_media(), segment);
    if constexpr (kAny)
      if (begins) segment.begin();
  }
  /// Whether a vertex ends its segment: false for null surfaces without a light, which only lie within a
  /// segment.
  static bool ends_segment(const Vertex& vertex) {
    return vertex.light() || has(vertex.surface().lobes, Lobe::reflect | Lobe::transmit);
  }
  /// Begins a walk from the sensor with the ray of the sample.
  void begin_at_sensor(int i) {
    State& s = states_[i];
    s.segment.ray = paths_[size_t(i)].ray;
    s.vertex = -1;
    if (const Receiver* receiver = paths_[size_t(i)].receiver) {
      // Light sampling has sampled the light that the ray may hit, as at a vertex.
      const float pdf = receiver->pdf(s.segment.ray.d);
      if (pdf > 0) s.density.r_l = 1 / pdf;
      s.from = {receiver->p, receiver->facing()};
    }
    if constexpr (kAny) {
      s.segment.begin();
      find_interiors(scene_, nullptr, s.segment);
    }
  }
  /// Samples a light for the present vertex of a path from the sensor, where it can be connected.
  [[gnu::always_inline]] LightSample sample_light(int i) {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (s.last || !vertex.is_smooth() || scene_.lights().empty()) return {};
    if constexpr (kAny)
      if (!vertex.is_surface() && !scene_.lights_reach(*s.segment.medium)) return {};
    return aureole::sample_light(
        scene_, vertex.p(), vertex.facing(),
        scene_.lights().is_single() ? 0.f : get(paths_[size_t(i)].samples, s.vertex, Choice::light),
        get(s.pairs, Pair::connection), wavelengths(i));
  }
  struct Emitted {
    LightChoice choice;
    EmittedRay ray;
    float pdf;  ///< pdf of position and direction, times the probability of choosing the light
  };
  /// Begins a light path by `u`, two numbers that choose the light; nothing where it carries no light.
  /// `probability`: of starting at a light at all.
  std::optional<Emitted> begin_at_light(int i, Vec2 u, float probability);

  const Scene& scene_;
  const PathLimits& limits_;
  const std::span<Path> paths_;
  const BatchLog& log_;
  State* const states_;                 ///< of each path
  WalkDiffraction* const diffraction_;  ///< of each path, apart from what every step uses
  typename Kind::Vertices vertices_;

private:
  /// Throughput relative to the start of the path, without the factor n^2 of radiance in a medium of index n.
  float relative(int i, const Density& density) const {
    const State& s = states_[i];
    const float throughput = density.hero_symmetric_throughput() * s.eta2;
    if constexpr (kAny) return throughput / s.first_throughput;
    return throughput;
  }
  /// The contact of surfaces that the path has hit; null where it has hit one surface alone.
  const Contact* meet(int i, const RayTracer::Hit& hit) {
    if (contacts_.empty() || !scene_.surfaces().of(hit).touches) return nullptr;
    Contact& contact = contacts_[std::size_t(i)];
    const Segment& segment = states_[i].segment;
    return find_contact(scene_, segment.ray, hit, segment, wavelengths(i), contact) ? &contact : nullptr;
  }
  /// Adds the radiance of a light that the ray has reached.
  void add_emission(int i, const Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    if constexpr (kDiffracts)
      if (!is_black(radiance)) {
        edges_.count_pending(self(), i);
        return self().emission(i, light, point, radiance * edges_.chain_factor(self(), i));
      }
    self().emission(i, light, point, radiance);
  }
  Event sample_medium(int i, float t_max);
  Event transmit(int i, float t_max);
  Event escape(int i);
  /// Logs the vertex that the path has arrived at.
  [[gnu::noinline, gnu::cold]] void log_vertex(int i, PathEvent::Kind kind, const Vec3& p,
                                               const SurfacePoint* point) {
    const State& s = states_[i];
    float throughput = s.density.hero_symmetric_throughput();
    if constexpr (kAny) throughput /= s.first_throughput;
    throughput *= edges_.chain_factor(self(), i)[0];
    log_({.kind = kind,
          .depth = s.depth + !kFromSensor,
          .p = p,
          .d = s.segment.ray.d,
          .throughput = throughput,
          .point = point,
          .in_medium = s.segment.medium});
  }

  /// contacts at the vertices of the paths, in scenes with surfaces that touch
  std::span<Contact> contacts_;
  PathList below_;  ///< paths that were refracted into a surface with a BSSRDF
  EdgeWalk edges_;
};

template <class Self, class Kind>
Event Walk<Self, Kind>::locate(int i, const RayTracer::Hit& hit) {
  State& s = states_[i];
  if constexpr (kAny) {
    const float t = hit ? hit.t : kInfinity;
    if (s.segment.medium) {
      self().before_distance(i, hit);
      const Event event = Kind::kScattersInMedia ? sample_medium(i, t) : transmit(i, t);
      if (event != Event::crossed) return event;
    }
    s.segment.behind += t;
  }
  if (!hit) return kFromSensor ? escape(i) : Event::escape;
  Path& path = paths_[size_t(i)];
  if constexpr (kAny) s.segment.contact = meet(i, hit);
  Vertex& vertex = vertices_.make(i, [&] {
    if (kAny && s.segment.contact)
      return Vertex(s.segment.contact->point, -s.segment.ray.d, path.wavelengths, kMode);
    return Vertex(scene_, hit, s.segment.ray, path.wavelengths, kMode);
  });
  if (kAny && s.segment.is_inactive(vertex.point(), path.wavelengths)) {
    ++s.vertex;  // the ray behind has random numbers of its own
    go_on(i, vertex, s.segment.ray.d, false);
    return Event::crossed;
  }
  return Event::surface;
}

/// Adds the emission of the surface that the path has hit; `surface` where the path has a vertex there, with its
/// random numbers. Else the limits end the path, or it goes on behind: an obstacle near edges that diffract, or a
/// light that is hidden.
template <class Self, class Kind>
[[gnu::always_inline]] inline Event Walk<Self, Kind>::emit(int i) {
  State& s = states_[i];
  Path& path = paths_[size_t(i)];
  Vertex& vertex = vertices_[i];
  // A light that `hide_emitters` makes invisible lies within the segment, as an inactive surface does.
  const bool is_hidden = kFromSensor && limits_.hide_emitters && s.depth == 0 && vertex.light();
  bool is_emission_counted = false;
  if constexpr (kAny)
    if (!vertex.is_passable() && !is_hidden) {
      const float behind = edges_.probability_behind(self(), i);
      if constexpr (kFromSensor)
        if (const Light* light = vertex.light(); light && behind > 0) {
          // The emission of a light counts whether or not the ray goes on behind it.
          is_emission_counted = true;
          edges_.count_pending(self(), i);
          self().emission(i, *light, &vertex.point(),
                          light->eval(vertex.point(), -s.segment.ray.d, path.wavelengths) *
                              edges_.factor(self(), i, s.segment.behind));
        }
      if (edges_.goes_behind(self(), i, behind)) {
        if (kFromSensor && s.depth == 0) path.result.alpha = 1;
        ++s.vertex;  // the ray behind has random numbers of its own
        go_on(i, vertex, s.segment.ray.d, false);
        return Event::crossed;
      }
    }
  if constexpr (kAny)
    if (!is_hidden && ends_segment(vertex))
      edges_.attenuate(self(), i, s.segment.behind, edges_.may_continue_chain(self(), i));
  if (log_.follows(i)) log_vertex(i, PathEvent::Kind::surface, vertex.p(), &vertex.point());
  if constexpr (kFromSensor) {
    if (const Light* light = vertex.light()) {
      if (is_hidden) {
        s.vertex += has_media();  // the ray behind has random numbers of its own
        go_on(i, vertex, s.segment.ray.d, false);
        return Event::crossed;
      }
      if (!is_emission_counted)
        add_emission(i, *light, &vertex.point(),
                     light->eval(vertex.point(), -s.segment.ray.d, path.wavelengths));
    }
    s.last = !reaches(i, 2);
    if (s.last && (!vertex.surface().passable || limits_.counts(vertex.surface()))) {
      if (s.depth == 0) path.result.alpha = 1;
      return Event::blocked;
    }
  }
  // Without media and contacts, a surface with a null component is treated as a null surface here.
  if constexpr (kAny)
    if (!vertex.is_passable() && !edges_.arrive(self(), i, vertex.p())) return Event::blocked;
  s.pairs = self().samples(i).directions(++s.vertex);
  vertex.prepare(vertex.surface().needs_choice ? key(self().samples(i), s.vertex, Stream::bsdf) : 0,
                 s.segment);
  if constexpr (kAny) s.is_connected = false;
  self().at_vertex(i);
  return Event::surface;
}

/// Through the medium along the ray: `medium` where the path is scattered there, `crossed` where it arrives
/// at the distance t_max.
template <class Self, class Kind>
[[gnu::noinline]] Event Walk<Self, Kind>::sample_medium(int i, float t_max) {
  State& s = states_[i];
  Path& path = paths_[size_t(i)];
  Vec3 p;
  Spectrum chosen;
  if (!sample_distance(s.segment, t_max, path.wavelengths, self().samples(i), s.vertex, s.density,
                       self().emission_in_media(i), p, self().emission_sampling(i), chosen))
    return Event::crossed;
  self().after_distance(i, p, chosen);
  edges_.attenuate(self(), i, s.segment.behind + dot(p - s.segment.ray.o, s.segment.ray.d));
  if (log_.follows(i)) log_vertex(i, PathEvent::Kind::medium, p, nullptr);
  if (kFromSensor && s.depth == 0) path.result.alpha = 1;
  if (!reaches(i, 2) || s.in_media == limits_.max_scattering || !s.density.has_light()) return Event::blocked;
  if (!edges_.arrive(self(), i, p)) return Event::blocked;
  ++s.in_media;
  s.last = s.is_connected = false;
  s.pairs = self().samples(i).directions(++s.vertex);
  vertices_.make(i, [&] { return Vertex({p, s.segment.medium}, -s.segment.ray.d, path.wavelengths, kMode); });
  self().at_vertex(i);
  return Event::medium;
}

/// Passes the medium along the ray by its transmittance, with its emission.
template <class Self, class Kind>
[[gnu::noinline]] Event Walk<Self, Kind>::transmit(int i, float t_max) {
  State& s = states_[i];
  Path& path = paths_[size_t(i)];
  SegmentEmission emission;
  const Transmittance light = transmittance(
      *s.segment.medium, s.segment.from_surface(), t_max + s.segment.offset, path.wavelengths,
      key(self().samples(i), s.vertex, Stream::distance), s.segment.medium->emits() ? &emission : nullptr);
  if constexpr (kFromSensor)
    if (!is_black(emission.radiance))
      path.result.estimate += s.density.seen(emission.radiance) / path.wavelengths.pdf;
  s.density.attenuate(light.value * light.roulette);
  return Event::crossed;
}

template <class Self, class Kind>
Event Walk<Self, Kind>::escape(int i) {
  State& s = states_[i];
  Path& path = paths_[size_t(i)];
  bool is_behind = false;
  if constexpr (kAny) {
    is_behind = diffraction(i).is_behind;
    edges_.attenuate(self(), i, kInfinity);
  }
  if (log_.follows(i)) log_({.kind = PathEvent::Kind::escape, .depth = s.depth, .d = s.segment.ray.d});
  if (s.depth == 0) {
    if (!is_behind)
      path.result.alpha = limits_.hide_emitters || scene_.infinite_emitters().empty() ? 0.f : 1.f;
    if (limits_.hide_emitters) return Event::escape;
  }
  if constexpr (kFromSensor)
    for (const Light* light : scene_.infinite_emitters())
      add_emission(i, *light, nullptr, light->eval_escaped(s.segment.ray.d, path.wavelengths));
  return Event::escape;
}

// The attribute inlines `scatter`, which is called once and large: GCC would not inline it (1 % of a path's
// instructions).
template <class Self, class Kind>
[[gnu::always_inline]] inline bool Walk<Self, Kind>::scatter(int i) {
  State& s = states_[i];
  Path& path = paths_[size_t(i)];
  const Vertex& vertex = vertices_[i];
  float to_edge = 0;
  if constexpr (kDiffracts)
    if (edges_.is_left(self(), i, to_edge)) return edges_.leave_vertex(self(), i, to_edge);
  if constexpr (!kFromSensor) {
    s.last = !reaches(i, 3);
    if (s.last && !vertex.is_passable() && !vertex.has_exit() && !self().follows_last(i)) return false;
  }
  const float lobe = vertex.needs_choice() ? get(self().samples(i), s.vertex, Choice::lobe) : 0.f;
  Scatter b;
  const Event event = vertex.scatter(lobe, get(s.pairs, Pair::scatter), b);
  if (event == Event::crossed) {
    if (limits_.counts(vertex.surface())) {
      if (s.last) return false;
      ++s.crossed;
    }
    s.density.attenuate(b.transmittance);
    if (kAny && to_edge > 0) s.density.survive(1 - to_edge);
    if (ends_segment(vertex)) edges_.cross_straight(self(), i);
    go_on(i, vertex, b.d, ends_segment(vertex));
    return true;
  }
  if (kFromSensor && s.depth == 0) path.result.alpha = 1;
  if (event == Event::blocked) return false;
  if constexpr (kFromSensor) {
    if (s.last) return false;
  } else {
    if ((s.last && event != Event::entered && !b.delta) || L::is_black(b.value)) return false;
  }
  if constexpr (kAny) {
    s.emission_counted = false;
    edges_.scatter(self(), i, b.delta);
    self().extend(i, b);
    edges_.continue_chain(self(), i, event, b);
    // The choice between an edge and a BSDF direction is in no MIS weight, like Russian roulette.
    if (to_edge > 0) s.density.survive(1 - to_edge);
  } else {
    self().extend(i, b);
  }
  self().scattered(i, b);
  if (!kFromSensor && s.last && event != Event::entered) return false;
  if (event == Event::entered) {
    if constexpr (Kind::kEmerges) below_.add(i);
    return false;
  }
  s.from.p = vertex.p();
  if constexpr (kFromSensor) s.from.facing = vertex.facing();
  go_on(i, vertex, b.d, true);
  ++s.depth;
  if constexpr (kFromSensor) s.eta2 *= b.eta * b.eta;
  if (!survives(i)) return false;
  if constexpr (kAny)
    if (s.segment.medium && self().may_cut_ray(i))
      cut_at_collision(s.segment, path.wavelengths, get(self().samples(i), s.vertex, Choice::distance));
  return true;
}

/// Russian roulette; false where the path ends.
template <class Self, class Kind>
bool Walk<Self, Kind>::survives(int i) {
  State& s = states_[i];
  if (s.depth >= limits_.roulette_depth) {
    const float survival = std::min(PathLimits::max_survival(s.depth), relative(i, s.density));
    if (!(get(self().samples(i), s.vertex, Choice::roulette) < survival)) return false;
    s.density.survive(survival);
  }
  if constexpr (!kFromSensor) return true;
  // Whether the last ray of a path counts, which can only find emission.
  bool finds_emission = true;
  if constexpr (kAny) finds_emission = !s.emission_counted;
  return reaches(i, 2) || (finds_emission && scene_.may_meet_emitter(s.segment.ray));
}

/// Subsurface scattering adds no segment to the path: light that leaves at an exit counts as scattered by the
/// surface.
template <class Self, class Kind>
void Walk<Self, Kind>::emerge(PathList& vertices) requires(Kind::kEmerges) {
  for (const int i : below_) {
    State& s = states_[i];
    if (!aureole::emerge(scene_, vertices_, i, paths_[size_t(i)].wavelengths, self().samples(i), kMode,
                         s.vertex, s.density, s.segment))
      continue;
    if (log_.follows(i)) log_vertex(i, PathEvent::Kind::exit, vertices_[i].p(), &vertices_[i].point());
    s.pairs = self().samples(i).directions(s.vertex);
    if constexpr (kAny) s.is_connected = false;
    vertices.add(i);
  }
  below_.clear();
}

template <class Self, class Kind>
auto Walk<Self, Kind>::begin_at_light(int i, Vec2 u, float probability) -> std::optional<Emitted> {
  State& s = states_[i];
  const auto choice = scene_.lights().choose_by_power(u, wavelengths(i).time);
  if (!choice) return {};
  SampleStream& samples = self().samples(i);
  const auto emitted = choice->light->sample_ray(choice->part, get(samples, 0, Pair::connection),
                                                 get(samples, 0, Pair::scatter), wavelengths(i));
  if (!emitted || is_black(emitted->value)) return {};
  const float pdf = probability * choice->probability * emitted->pdf_position * emitted->pdf_direction;
  if (!(pdf > 0)) return {};
  s.density.beta = L::emitted(emitted->value);
  s.density.survive(pdf);
  s.first_throughput = s.density.hero_symmetric_throughput();
  diffraction(i).begins_at_infinity = choice->light->is_infinite();
  const RayOrigin from = RayOrigin::of(*emitted);
  s.segment.ray = from.spawn(emitted->d);
  s.segment.ray.time = wavelengths(i).time;
  s.segment.offset = from.offset(s.segment.ray);
  s.segment.begin();
  find_interiors(scene_, choice->light, s.segment);
  if (log_.follows(i))
    log_({.kind = PathEvent::Kind::start,
          .p = s.segment.ray.o,
          .d = s.segment.ray.d,
          .light = choice->light,
          .part = choice->part});
  return Emitted{*choice, *emitted, pdf};
}

/// Calls begin(walk, rays), which begins paths and adds their rays, and follows them.
template <class W, class Begin>
void follow_from(const WalkInput& in, W& walk, const Begin& begin) {
  Driver driver(in.scene, walk, in.arena, in.paths.size());
  begin(walk, driver.rays());
  driver.follow(RayTracer::Rays::incoherent);
}
/// Begins all paths of the walk at the sensor or the lights, and follows them.
template <class W>
void follow_from_start(const WalkInput& in, W& walk) {
  Driver driver(in.scene, walk, in.arena, in.paths.size());
  for (int i = 0; i < int(in.paths.size()); ++i)
    if (walk.start(i)) driver.rays().add(i, walk.ray(i));
  driver.follow(W::kFromSensor ? RayTracer::Rays::coherent : RayTracer::Rays::incoherent);
}

}  // namespace aureole
