// SPDX-License-Identifier: Apache-2.0
// `EdgeWalk`: diffraction in a random walk (docs/diffraction_beams.md). `Walk` calls it at every step, so that
// integrators need not know whether a scene has edges that diffract light. Without such edges every function
// returns at once.
#pragma once

#include <span>

#include "aureole/transport/edges.h"
#include "aureole/transport/path.h"
#include "aureole/transport/path_log.h"
#include "aureole/transport/segment_diffraction.h"
#include "aureole/transport/two_way.h"
#include "aureole/transport/walk_state.h"

namespace aureole {

/// Whether edges of the scene diffract light.
inline bool has_diffracting_edges(const Scene& scene) {
  return scene.diffraction() && scene.diffraction()->has_edges();
}

/// Whether walks with that density leave their vertices for edges. Light paths of `bdpt` only need to sample
/// edges that the sensor sees in mirrors or smooth glass.
template <class Density>
bool walks_to_edges(const Scene& scene) {
  if (!has_diffracting_edges(scene)) return false;
  return !std::is_same_v<Density, LightSubpathDensity<Unpolarised>> ||
         scene.diffraction()->edges().has_mirrors();
}

/// Samples light of one emitter that reaches the sensor around one edge, for one path; nothing where it is
/// black.
inline std::optional<Splat> light_seen_around_edge(const Scene& scene, int index, Path& path,
                                                   const PathLimits& limits) {
  EdgePaths edges(scene, path.wavelengths, key(path.samples, 0, Stream::diffracted_light),
                  limits.hide_emitters);
  edges.limit_crossings(limits.crossings_left(2));
  const Vec2 lens = edges.next2();
  Splat splat{index, {}, 0.f};
  splat.estimate = single_estimate(edges.from_light_to_sensor(lens, splat.film), path.wavelengths);
  if (is_black(splat.estimate)) return {};
  return splat;
}

class EdgeWalk {
public:
  explicit EdgeWalk(const Scene& scene) : scene_(scene), is_on_(has_diffracting_edges(scene)) {}

  /// Multiplies the path's throughput by the diffraction factor of a segment of the given length along the
  /// present ray. `is_kept`: its end is a vertex with `may_continue_chain`; the segment is kept in the path's chain
  /// instead.
  template <class W>
  void attenuate(W& walk, int i, float length, bool is_kept = false) const {
    if (!W::kDiffracts || (!scene_.diffraction() && !scene_.outline_edges())) return;
    auto& s = walk.state(i);
    if (scene_.outline_edges()) {
      auto& state = walk.diffraction(i);
      if (is_kept || state.chain.is_linked()) {
        state.chain.arrive(leg(walk, i, length), state.begins_at_infinity);
        if (!is_kept) end_chain(walk, i);
      } else if (!state.is_clear) {
        const PathLeg segment = leg(walk, i, length);
        if (!defers(walk, i) || !state.pending.add({&segment, 1}))
          s.density.attenuate(factor(walk, i, length));
      }
      state.is_behind = state.begins_at_infinity = state.is_clear = false;
      return;
    }
    const LightWay segment{s.segment.origin, s.segment.ray.d, length, walk.diffraction(i).end()};
    s.density.attenuate(left_by_edges(scene_, segment, walk.wavelengths(i),
                                      key(walk.samples(i), s.vertex, Stream::distance)));
  }

  /// Multiplies the path's throughput by the diffraction factors that it does not contain yet, and returns them. It
  /// is called before the path adds light to the result.
  template <class W>
  Spectrum count_pending(W& walk, int i) const {
    if constexpr (W::kDiffracts && W::kDefersDiffraction) {
      auto& s = walk.state(i);
      if (walk.diffraction(i).pending.is_empty()) return 1.f;
      const Spectrum factors = walk.diffraction(i).pending.take_factors(scene_, walk.wavelengths(i));
      s.density.attenuate(factors);
      return factors;
    } else {
      return 1.f;
    }
  }

  /// Whether light may keep its phase at the present vertex: its surface may be crossed straight, or is a planar
  /// mirror.
  template <class W>
  bool may_continue_chain(W& walk, int i) const {
    if constexpr (!W::kDiffracts) {
      return false;
    } else {
      if (!scene_.outline_edges()) return false;
      const auto& vertex = walk.vertex(i);
      // Connections of `bdpt` have the factors of both subpaths up to their ends, which end chains.
      if (kTwoWay<W> && vertex.is_smooth()) return false;
      return vertex.is_passable() || (has(vertex.surface().lobes, Lobe::delta) && is_flat(vertex.point()));
    }
  }
  /// The diffraction factor of the path's chain, which ends at the present vertex, and which the throughput does not
  /// contain; 1 if there is none.
  template <class W>
  Spectrum chain_factor(W& walk, int i) const {
    if constexpr (W::kDiffracts)
      if (scene_.outline_edges()) {
        SegmentChain& chain = walk.diffraction(i).chain;
        if (!chain.is_empty() && !chain.is_linked()) return chain.factor(scene_, walk.wavelengths(i));
      }
    return 1.f;
  }
  /// Continues the chain behind the present vertex, which the path has crossed.
  template <class W>
  void cross_straight(W& walk, int i) const {
    if constexpr (W::kDiffracts)
      if (scene_.outline_edges() && !walk.diffraction(i).chain.is_empty())
        walk.diffraction(i).chain.link_straight();
  }
  /// Continues the chain behind the present vertex, at which the path was scattered, if that is a planar mirror.
  /// Otherwise multiplies the throughput by the chain's factor.
  template <class W, class Scatter>
  void continue_chain(W& walk, int i, Event event, const Scatter& b) const {
    if constexpr (W::kDiffracts) {
      if (!scene_.outline_edges()) return;
      SegmentChain& chain = walk.diffraction(i).chain;
      if (chain.is_empty()) return;
      const SurfacePoint& point = walk.vertex(i).point();
      if (event == Event::surface && b.delta && b.eta == 1 && is_flat(point)) {
        // Largest difference of two directions that is due to rounding.
        constexpr float kRounding = 1e-5f;
        const Vec3& d = walk.state(i).segment.ray.d;
        // Surfaces that light crosses straight without being null surfaces occlude edges behind them.
        const Vec3 mirrored = d - point.ng * (2 * dot(d, point.ng));
        if (length_squared(b.d - mirrored) < kRounding * kRounding && chain.link_by_mirror(point.p, point.ng))
          return;
      }
      end_chain(walk, i);
    }
  }

  /// The probability with which the present ray continues behind the obstacle that it has hit, into the shadow:
  /// above 0 where edges are near the ray.
  template <class W>
  float probability_behind(W& walk, int i) const {
    // Paths of `bdpt` end at obstacles: the MIS weights of their techniques would need the choice in both directions.
    if constexpr (!W::kDiffracts || kTwoWay<W>) {
      return 0;
    } else {
      if (!scene_.outline_edges()) return 0;
      auto& s = walk.state(i);
      auto& state = walk.diffraction(i);
      const SegmentChain* before = state.chain.is_linked() ? &state.chain : nullptr;
      state.is_clear = !before && !state.begins_at_infinity && !state.is_behind &&
                       !has_edges_near(scene_, s.segment.origin, s.segment.ray.d, walk.wavelengths(i));
      if (state.is_clear) return 0;
      return aureole::probability_behind(scene_, s.segment.origin, s.segment.ray.d,
                                         before ? before->begins_at_infinity() : state.begins_at_infinity,
                                         walk.wavelengths(i), before);
    }
  }
  /// Whether it continues, which it does with that probability. Connections find light behind obstacles without this
  /// choice, so that it counts in the MIS weights of the light that the ray hits there.
  template <class W>
  bool goes_behind(W& walk, int i, float probability) const {
    if (!(probability > 0)) return false;
    auto& s = walk.state(i);
    const bool goes_on = KeyedRandom(walk_key(walk, i)).next() < probability;
    s.density.survive(goes_on ? probability : 1 - probability);
    if (goes_on) {
      s.density.r_l *= 1 / probability;
      walk.diffraction(i).is_behind = true;
    }
    return goes_on;
  }
  /// The diffraction factor of the present ray up to a distance, with that of the chain that it continues, in scenes
  /// with the model "segments".
  template <class W>
  Spectrum factor(W& walk, int i, float length) const {
    const auto& state = walk.diffraction(i);
    SegmentChain chain;
    if (state.chain.is_linked()) chain = state.chain;
    chain.arrive(leg(walk, i, length), state.begins_at_infinity);
    return chain.factor(scene_, walk.wavelengths(i));
  }

  /// Updates the path at a vertex at `p`. Returns false where the path ends, because `p` lies within the beam
  /// of the edge that it has left.
  template <class W>
  bool arrive(W& walk, int i, const Vec3& p) const {
    auto& s = walk.state(i);
    return !walk.diffraction(i).is_set ||
           walk.diffraction(i).leaves_beam(scene_, p, walk.wavelengths(i), s.density);
  }

  /// Whether the path leaves its vertex for an edge, which it does with the probability that `probability`
  /// receives.
  template <class W>
  bool is_left(W& walk, int i, float& probability) const {
    if (!is_on_ || !walks_to_edges<typename W::Density>(scene_)) return false;
    auto& s = walk.state(i);
    const auto& vertex = walk.vertex(i);
    if (!vertex.is_smooth() || !walk.limits().reaches(s.crossed + s.depth + 4 + kSegmentsBehind<W>))
      return false;
    probability = EdgePaths::to_edge(scene_, vertex.p(), walk.wavelengths(i));
    return KeyedRandom(walk_key(walk, i)).next() < probability;
  }
  /// Continues the path by way of an edge. False where it ends.
  template <class W>
  [[gnu::noinline]] bool leave_vertex(W& walk, int i, float probability) const {
    auto& s = walk.state(i);
    if (W::kFromSensor && s.depth == 0) walk.path(i).result.alpha = 1;
    KeyedRandom random(walk_key(walk, i));
    random.next();
    EdgePaths edges(scene_, walk.wavelengths(i), random, walk.limits().hide_emitters);
    edges.limit_crossings(walk.limits().crossings_left(s.crossed + s.depth + 4 + kSegmentsBehind<W>));
    Spectrum value;
    EdgePaths::AtEdge at;
    s.density = walk.vertex_density(i);
    if (!edges.walk(walk.vertex(i), s.segment, probability, value, at)) return false;
    ++s.depth;
    return leave_edge(walk, i, edges, at, value);
  }

  /// Updates the state of a path that is scattered at a vertex.
  template <class W>
  void scatter(W& walk, int i, bool delta) const {
    auto& after = walk.diffraction(i);
    after.is_set = false;
    if constexpr (kIsTwoWayLight<W>) {
      // An edge before a mirror is sampled from the light, any other edge from the sensor.
      if (after.is_next) after.found_from_sensor = !delta;
      after.is_next = false;
    }
  }

  /// Begins a path at an edge that the sensor sees at `film`, or that a light irradiates. Returns false where
  /// there is none.
  template <class W>
  bool begin(W& walk, int i, Vec2& film) const {
    if (!walk.limits().reaches(3 + kSegmentsBehind<W>)) return false;
    auto& s = walk.state(i);
    EdgePaths edges(scene_, walk.wavelengths(i), key(walk.samples(i), 0, Stream::diffracted_start),
                    walk.limits().hide_emitters);
    edges.limit_crossings(walk.limits().crossings_left(3 + kSegmentsBehind<W>));
    Spectrum value = 1.f;
    EdgePaths::AtEdge at;
    if constexpr (W::kFromSensor) {
      s.vertex = -1;
      if (!edges.begin_at_sensor(edges.next2(), value, at, film)) return false;
    } else {
      if (!edges.begin_at_light(value, at)) return false;
      s.density.beta = 1.f;  // `value` includes the light
    }
    s.first_throughput = max_component(abs(value));
    return leave_edge(walk, i, edges, at, value);
  }

  /// Next-event estimation around edges: connects the vertices with lights or, from light paths, with the
  /// sensor.
  template <class W>
  void connect(W& walk, const PathList& vertices) const {
    if (!is_on_ || kIsTwoWayLight<W>) return;
    for (const int i : vertices) {
      auto& s = walk.state(i);
      const auto& vertex = walk.vertex(i);
      if ((W::kFromSensor && s.last) || !vertex.is_smooth() ||
          !walk.limits().reaches(s.crossed + s.depth + 3) || !walk.has_technique(1, s.depth + 3))
        continue;
      EdgePaths edges(scene_, walk.wavelengths(i),
                      key(walk.samples(i), s.vertex, Stream::diffracted_connection),
                      walk.limits().hide_emitters);
      edges.limit_crossings(walk.limits().crossings_left(s.crossed + s.depth + 3));
      const auto respond = [&](const Vec3& d) { return EdgePaths::response(vertex, d); };
      const EdgePaths::Place place = EdgePaths::at_vertex(vertex, s.segment);
      const float throughput = walk.relative_throughput(i);
      if constexpr (W::kFromSensor) {
        const EdgePaths::Beside beside = s.is_connected              ? EdgePaths::Beside::direct
                                         : walk.has_indirect_light() ? EdgePaths::Beside::surfaces
                                                                     : EdgePaths::Beside::nothing;
        Spectrum light = 0.f;
        for (int k = 0; k < walk.edge_samples(); ++k)
          light += edges.from_light(place, beside, throughput, respond);
        light *= 1 / float(walk.edge_samples());
        Path& path = walk.path(i);
        path.result.estimate += walk.vertex_density(i).contribution(light, path.wavelengths);
        if (walk.log().follows(i) && !is_black(light))
          walk.log()({.kind = PathEvent::Kind::other, .estimate = light, .text = "light around an edge"});
      } else if constexpr (!kIsTwoWayLight<W>) {
        connect_with_sensor(walk, i, edges, place, s.is_connected, throughput, respond);
      }
    }
  }

private:
  /// Whether paths of `bdpt` are followed, of which the vertices are connected by several techniques.
  template <class W>
  static constexpr bool kTwoWay = requires(typename W::Density density) {
    density.earlier;
  };
  /// Whether the diffraction factors of the path are deferred. Logs state throughputs that contain them.
  template <class W>
  static bool defers(W& walk, int i) {
    return W::kDefersDiffraction && !walk.log().follows(i);
  }
  /// The present segment up to a distance.
  template <class W>
  static PathLeg leg(W& walk, int i, float length) {
    const auto& segment = walk.state(i).segment;
    return {segment.origin, segment.ray.d, length, !walk.diffraction(i).is_behind};
  }
  /// Ends the chain at the present vertex: the throughput contains its factor then, or the path defers it.
  template <class W>
  void end_chain(W& walk, int i) const {
    auto& state = walk.diffraction(i);
    if (state.chain.has_factor() || state.chain.begins_at_infinity() || !defers(walk, i) ||
        !state.pending.add(state.chain.legs()))
      walk.state(i).density.attenuate(state.chain.factor(scene_, walk.wavelengths(i)));
    state.chain.clear();
  }

  template <class W>
  static constexpr bool kIsTwoWayLight =
      std::is_same_v<typename W::Density, LightSubpathDensity<Unpolarised>>;
  /// Least number of segments that a path has behind its next vertex: light paths of `bdpt` are not connected
  /// with the sensor at edges.
  template <class W>
  static constexpr int kSegmentsBehind = kIsTwoWayLight<W>;

  template <class W>
  static std::uint32_t walk_key(W& walk, int i) {
    return key(walk.samples(i), walk.state(i).vertex, Stream::diffracted_walk);
  }

  template <class W, class Respond>
  static void connect_with_sensor(W& walk, int i, EdgePaths& edges, const EdgePaths::Place& from,
                                  bool is_seen, float throughput, const Respond& respond) {
    Vec2 film;
    const Vec2 lens = edges.next2();
    const Spectrum seen = edges.to_sensor(from, is_seen, throughput, lens, respond, film);
    if (is_black(seen)) return;
    const Spectrum estimate = walk.state(i).density.reached(Weight(seen), 1, walk.wavelengths(i));
    walk.splat(i, film, estimate);
    if (walk.log().follows(i))
      walk.log()({.kind = PathEvent::Kind::other,
                  .estimate = estimate,
                  .film = film,
                  .text = "sensor around an edge"});
  }

  /// Continues a path from an edge, possibly by way of other edges, into a direction. The state of the path
  /// becomes the state behind the last edge.
  template <class W>
  bool leave_edge(W& walk, int i, EdgePaths& edges, const EdgePaths::AtEdge& first,
                  const Spectrum& value) const {
    auto& s = walk.state(i);
    const auto connect = [&](const EdgePaths::AtEdge& at, const Spectrum& so_far) {
      if (walk.log().follows(i))
        walk.log()({.kind = PathEvent::Kind::edge, .depth = s.depth + !W::kFromSensor, .p = at.point.p});
      const auto respond = [&](const Vec3& d) { return edges.kernel(at, d); };
      if constexpr (W::kFromSensor) {
        if (walk.has_technique(1, s.depth + 3)) {
          Path& path = walk.path(i);
          path.result.estimate += s.density.contribution(
              so_far * edges.from_light(at.place(), EdgePaths::Beside::nothing, 1, respond),
              path.wavelengths);
        }
        if constexpr (requires { walk.last_light_vertex(i); })
          for (const LightVertex<Unpolarised>* light = walk.last_light_vertex(i); light;
               light = light->previous)
            connect_with_light_vertex(walk, i, edges, at, so_far, *light);
      } else if constexpr (!kIsTwoWayLight<W>) {
        connect_with_sensor(walk, i, edges, at.place(), false, 1,
                            [&](const Vec3& d) { return so_far * respond(d); });
      }
    };
    const auto reaches = [&](int n) {
      s.crossed += edges.take_crossed();
      edges.limit_crossings(walk.limits().crossings_left(s.crossed + n));
      return walk.limits().reaches(s.crossed + n);
    };
    if (!edges.leave(first, value, s.depth, reaches, connect, s.density, s.segment, walk.diffraction(i)))
      return false;
    s.segment.begin();
    if constexpr (requires { s.density.leave_edge(0.f, true); }) {
      s.density.leave_edge(walk.diffraction(i).pdf, W::kFromSensor);
      s.from.p = walk.diffraction(i).edge;
    }
    if constexpr (kIsTwoWayLight<W>)
      walk.diffraction(i).found_from_sensor = walk.diffraction(i).is_next = true;
    // Connections before the edge have already counted the lights that the path hits next.
    s.emission_counted = true;
    ++s.vertex;
    return walk.survives(i);
  }

  /// Connects an edge that a path of `bdpt` has reached, with the factor `value`, to a vertex of a light
  /// path.
  template <class W>
  void connect_with_light_vertex(W& walk, int i, EdgePaths& edges, const EdgePaths::AtEdge& at,
                                 const Spectrum& value, const LightVertex<Unpolarised>& light) const {
    const auto& s = walk.state(i);
    if (!walk.may_connect(i, light)) return;
    const float distance2 = length_squared(light.vertex.p() - at.point.on_edge());
    if (!(distance2 > 0)) return;
    const Vec3 d = -at.point.direction_from(light.vertex.p());
    if (!SceneEdges::turns_around(at.point, at.d, d)) return;
    Response there;
    if (!light.vertex.respond(-d, there)) return;
    Path& path = walk.path(i);
    const RayOrigin edge = RayOrigin::in_space(at.point.p);
    Connection c;
    c.set(edge, normalize(light.vertex.p() - edge.p), light.vertex.origin());
    const float inverse = 1 / distance2;
    // Pdf of the other techniques: the walk of the sensor's path, and those of the light path behind the
    // vertex. Light paths do not sample this edge.
    const Spectrum other = s.density.r_u * light.vertex.density_across(d) *
                           light.density.others(light.vertex.reverse_pdf(-d)) *
                           (edges.scatter_pdf(at, d) * inverse);
    walk.weigh(s.density.r_u * light.density.r_u, other, path.wavelengths, c);
    c.crossings_left = walk.limits().crossings_left(s.crossed + s.depth + 2 + light.edges + light.crossed);
    if (scene_.has_media())
      c.begin_in(at.state,
                 std::uint32_t(combine_bits(key(walk.samples(i), s.vertex, Stream::diffracted_connection),
                                            std::uint64_t(light.edges))));
    if (!is_visible(scene_, c, path.wavelengths)) return;
    c.passage *=
        left_by_edges(scene_, LightWay::of(c, LightWay::End::edge), path.wavelengths, walk.connection_key(i));
    const Spectrum kernel = edges.kernel_to(at, d, light.vertex, std::sqrt(distance2));
    if (is_black(kernel)) return;
    path.result.estimate +=
        s.density.beta.of(value * kernel * (there.value.of(light.density.beta) * inverse)) * c.passage;
    if (walk.log().follows(i))
      walk.log()(
          {.kind = PathEvent::Kind::other, .estimate = c.passage * kernel, .text = "connection of the edge"});
  }

  const Scene& scene_;
  const bool is_on_;
};

/// Follows paths that begin at edges, and adds light that reaches the sensor around one edge alone. The paths
/// of `in` are followed once more, with random numbers of their own: the `stream`-th second stream of each.
/// `sees_lights`: whether paths with one edge between a light and the sensor count. `run(second, begin)`
/// makes a walk of the input `second`, calls begin(walk, rays), which adds the rays of the paths that have
/// begun, and follows them. The light that they find is added as splats.
template <class Run>
[[gnu::noinline]] void follow_diffracted_paths(const WalkInput& in, int stream, bool sees_lights,
                                               std::vector<Splat>& splats, Run&& run) {
  if (!has_diffracting_edges(in.scene) || !in.limits.reaches(2)) return;
  const std::size_t n = in.paths.size();
  const std::span<Path> second = in.arena.make<Path>(n);
  Vec2* const film = in.arena.allocate<Vec2>(n);
  for (std::size_t i = 0; i < n; ++i) {
    second[i] = in.paths[i];
    for (int k = 0; k < stream; ++k) second[i].samples = second[i].samples.of_second_path();
    second[i].result = {};
  }
  run(WalkInput{in.scene, in.limits, second, in.log, in.arena}, [&](auto& walk, BatchRays& rays) {
    for (std::size_t i = 0; i < n; ++i) {
      if (sees_lights)
        if (const auto splat = light_seen_around_edge(in.scene, int(i), in.paths[i], in.limits))
          splats.push_back(*splat);
      film[i] = {-1, -1};
      if (walk.begin_at_edge(int(i), film[i])) rays.add(int(i), walk.ray(int(i)));
    }
  });
  for (std::size_t i = 0; i < n; ++i) {
    const Spectrum& estimate = second[i].result.estimate;
    if (!is_finite(estimate))
      in.paths[i].result.invalidate();
    else if (!is_black(estimate))
      splats.push_back({int(i), film[i], estimate});
  }
}

/// Adds light that reaches the sensor around one edge alone, for integrators without paths that begin at
/// edges.
inline void see_diffracted_light(const WalkInput& in, std::vector<Splat>& splats) {
  if (!has_diffracting_edges(in.scene)) return;
  for (std::size_t i = 0; i < in.paths.size(); ++i)
    if (const auto splat = light_seen_around_edge(in.scene, int(i), in.paths[i], in.limits))
      splats.push_back(*splat);
}

/// Follows light paths of `bdpt` that begin at an edge, where the scene needs them; `run(begin)` as above,
/// without random numbers of its own.
template <class Walk, class Run>
void follow_diffracted_light_paths(const WalkInput& in, Run&& run) {
  if (!walks_to_edges<typename Walk::Density>(in.scene)) return;
  run([&](Walk& walk, BatchRays& rays) {
    Vec2 film;
    for (std::size_t i = 0; i < in.paths.size(); ++i)
      if (walk.begin_at_edge(int(i), film)) rays.add(int(i), walk.ray(int(i)));
  });
}

}  // namespace aureole
