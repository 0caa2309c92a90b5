// SPDX-License-Identifier: Apache-2.0
// Paths around edges that diffract light (docs/diffraction.md). A place on an edge is a vertex without area:
// light comes to it and leaves it by the kernel of `SceneEdges`.
//
// Each place on an edge is found in one way only. Where it is the neighbour of the path's far end (a light in
// `path`, `direct` and `bdpt`, the sensor in `ptracer`), it is chosen for the two places that it lies
// between, as an end that connections look for. Else a walk goes there: it leaves its vertex for an edge with
// the probability `to_edge`, and goes on behind it by the edge's kernel. The weights of `bdpt` for the rest
// of such paths are in integrator/bdpt/subpath.h.
#pragma once

#include <optional>
#include <utility>

#include "aureole/core/keyed_random.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/edge_ledger.h"
#include "aureole/transport/ray_origin.h"
#include "aureole/transport/vertex.h"

namespace aureole {

/// Where a path has left an edge, until it comes to a vertex.
struct AfterEdge {
  Vec3 edge;
  bool is_set = false;
  float pdf = 0;  ///< with which the direction was chosen [1/sr]
  // For light paths of `bdpt`:
  bool found_from_sensor =
      false;             ///< the path's last edge is found from the sensor: its vertices are not connected
  bool is_next = false;  ///< the vertex before the present one is an edge
  /// For light paths with the diffraction model "segments": the ray went on behind an obstacle.
  bool is_behind = false;
  /// Diffraction model "segments": the present segment comes from a light at infinity.
  bool begins_at_infinity = false;

  /// Where the path's flight has begun.
  LightWay::End end() const { return is_set ? LightWay::End::edge : LightWay::End::vertex; }

  /// At a vertex: false where it lies in the edge's beam at all wavelengths, which those where it does lose.
  template <class Density>
  [[gnu::noinline]] bool leaves_beam(const Scene& scene, const Vec3& p, const Wavelengths& w,
                                     Density& density) {
    density.attenuate(SceneEdges::far_enough(length(p - edge), false, scene.diffraction()->edges().beams(w)));
    is_set = false;
    return density.has_light();
  }
};

/// Paths around edges of one scene, for one path.
class EdgePaths {
public:
  /// Probability of leaving an edge for another edge.
  static constexpr float kToNextEdge = 0.25f;
  /// Probability of leaving a vertex for an edge: seldom where edges are far or beams narrow.
  static float to_edge(const Scene& scene, const Vec3& p, const Wavelengths& w) {
    return std::clamp(8 * scene.diffraction()->edges().seen_from(p, scene.diffraction()->edges().beams(w)),
                      1 / 64.f, 0.25f);
  }

  EdgePaths(const Scene& scene, const Wavelengths& w, std::uint32_t key, bool hide_emitters = false)
      : EdgePaths(scene, w, KeyedRandom(key), hide_emitters) {}
  /// `random` may have been asked before.
  EdgePaths(const Scene& scene, const Wavelengths& w, const KeyedRandom& random, bool hide_emitters = false)
      : scene_(scene),
        edges_(scene.diffraction()->edges()),
        w_(w),
        beams_(edges_.beams(w)),
        random_(random),
        hide_emitters_(hide_emitters) {}

  /// Sets how many surfaces the path may cross from here on that count for the limit of segments; at first there
  /// is no limit.
  void limit_crossings(int left) { crossings_allowed_ = crossings_left_ = left; }
  /// Returns how many of them it has crossed on its way from edge to edge since it was last asked.
  int take_crossed() { return std::exchange(crossings_allowed_, crossings_left_) - crossings_left_; }

  /// A place of a path that light goes from or to around an edge: a vertex or another edge.
  struct Place {
    RayOrigin origin;
    const RayState* state;           ///< that has led there, or leaves an edge
    const Vertex* vertex = nullptr;  ///< null: an edge

    LightWay::End end() const { return vertex ? LightWay::End::vertex : LightWay::End::edge; }
    RayState leaving(const Vec3& d) const { return vertex ? vertex->leaving(d, *state) : *state; }
  };
  static Place at_vertex(const Vertex& vertex, const RayState& state) {
    return {vertex.origin(), &state, &vertex};
  }
  /// The response of a vertex in a direction to light of 1 at all wavelengths.
  static Spectrum response(const Vertex& vertex, const Vec3& d) {
    Response r;
    return vertex.respond(d, r) ? r.value.of(1.f) : Spectrum(0.f);
  }
  /// At an edge: the place on it and the direction of travel of the path that has come there.
  struct AtEdge {
    EdgePoint point;
    Vec3 d;
    RayState state;  ///< there, without a ray

    Place place() const { return {RayOrigin::in_space(point.p), &state}; }
  };

  /// Other light at a place, beside which what edges send there is looked at less often: none, that of a lamp
  /// without going around an edge, or light by way of surfaces, as the scene's shadows have it.
  enum class Beside : std::uint8_t { nothing, direct, surfaces };

  /// Light of a lamp that reaches `from` around one edge, scattered there by respond(d) -> Spectrum, d the
  /// direction to the edge; black where there is none. `left`: about the part of the path's weight that is
  /// left there, which is the probability of looking.
  template <class Respond>
  Spectrum from_light(const Place& from, Beside beside, float left, const Respond& respond) {
    LampEnd lamp;
    float whole = looked_at(left);
    if (whole == 0 || !choose_lamp(lamp)) return 0.f;
    whole *= looked_for(from.origin.p, lamp.per_distance, beside == Beside::direct);
    if (whole == 0 || !find_guide(from.origin.p, lamp)) return 0.f;
    const auto point = choose_between(from.origin.p, lamp.guide, lamp.lit, beside, whole);
    if (!point) return 0.f;
    const Vec3 d = point->direction_from(from.origin.p);
    const Spectrum response = respond(d) * whole;
    return is_black(response) ? response : response * light_at(from, *point, d, lamp);
  }
  /// The sensor's response to light that leaves `from` with respond(d) and goes around one edge, seen at
  /// `film`; `is_seen`: the sensor sees that place without going around an edge.
  template <class Respond>
  Spectrum to_sensor(const Place& from, bool is_seen, float left, Vec2 lens, const Respond& respond,
                     Vec2& film) {
    float whole = looked_at(left);
    if (whole == 0) return 0.f;
    const Vec3 eye = sensor_guide(from.origin.p, lens);
    whole *= looked_for(from.origin.p, edges_.per_distance(eye, 0), is_seen);
    if (whole == 0) return 0.f;
    const auto point = choose_between(from.origin.p, PathEnd{eye}, nullptr,
                                      is_seen ? Beside::direct : Beside::nothing, whole);
    if (!point) return 0.f;
    const Vec3 d = point->direction_from(from.origin.p);
    const Spectrum response = respond(d) * whole;
    return is_black(response) ? response : response * sensor_at(from, *point, d, lens, film);
  }
  /// The sensor's response to light of a lamp around one edge. Looked at seldom where the sensor does not see
  /// an edge that is chosen by chance.
  Spectrum from_light_to_sensor(Vec2 lens, Vec2& film);

  /// Goes from a place to an edge: false where that is not seen. `value` is multiplied by what arrives there
  /// over the density.
  template <class Respond>
  bool walk(const Place& from, const Respond& respond, Spectrum& value, AtEdge& out,
            const MeshEdge* leaving = nullptr) {
    const float u[3] = {random_.next(), random_.next(), random_.next()};
    const auto point = edges_.choose_from({from.origin.p}, u, leaving);
    if (!point || !(point->pdf > 0)) return false;
    const Vec3 d = point->direction_from(from.origin.p);
    const Spectrum geometry = reach(from, *point);
    if (is_black(geometry)) return false;
    value *= respond(d) * geometry;
    return !is_black(value) && arrive(from, *point, d, false, value, out);
  }
  /// The same from a vertex that is left for an edge with that probability.
  bool walk(const Vertex& vertex, const RayState& state, float probability, Spectrum& value, AtEdge& out) {
    value = 1 / probability;
    return walk(
        at_vertex(vertex, state), [&](const Vec3& d) { return response(vertex, d); }, value, out);
  }
  /// From an edge, which a path has come to with the factor `value`, perhaps by way of other edges, into a
  /// direction: `density`, `state` and `after` become those of the path behind it. `scattered` counts the
  /// path's vertices, one for each edge; reaches(n): paths of n edges count (called before each step, so that it may limit
  /// crossings); see(at, value) connects every
  /// edge with the path's far end. False where the path ends.
  template <class Density, class Reaches, class See>
  bool leave(AtEdge at, Spectrum value, int& scattered, const Reaches& reaches, const See& see,
             Density& density, RayState& state, AfterEdge& after) {
    for (;;) {
      if (!reaches(scattered + 3)) return false;
      see(at, value);
      if (random_.next() >= kToNextEdge) break;
      if (!reaches(scattered + 4)) return false;
      value *= 1 / kToNextEdge;
      AtEdge next;
      if (!walk(
              at.place(), [&](const Vec3& d) { return kernel(at, d); }, value, next, at.point.edge))
        return false;
      at = next;
      ++scattered;
    }
    value *= 1 / (1 - kToNextEdge);
    Vec3 d;
    float pdf;
    if (!scatter(at, value, d, pdf)) return false;
    density.extend(Weight(value), 1.f, true);
    state = at.state;
    state.ray = RayOrigin::in_space(at.point.p).spawn(d);
    state.offset = 0;
    after = {at.point.on_edge(), true, pdf};
    ++scattered;
    return true;
  }
  /// The first edge of a path from the sensor, seen at `film`.
  bool begin_at_sensor(Vec2 lens, Spectrum& value, AtEdge& out, Vec2& film);
  /// The same from a lamp.
  bool begin_at_light(Spectrum& value, AtEdge& out);

  /// A direction behind the edge; `value` is multiplied by the kernel over the density. False where the path
  /// ends.
  bool scatter(const AtEdge& at, Spectrum& value, Vec3& d, float& pdf);
  float scatter_pdf(const AtEdge& at, const Vec3& d) const {
    return edges_.scatter_pdf(at.point, at.d, d, beams_);
  }

  /// Drawn by numbers of its own.
  Spectrum kernel(const AtEdge& at, const Vec3& d) { return kernel(at.point, at.d, d); }
  /// K between an edge that a path has come to and a vertex of another one, `distance` from it; 0 where the
  /// vertex lies in the edge's beam.
  Spectrum kernel_to(const AtEdge& at, const Vec3& d, const Vertex& vertex, float distance) {
    if (vertex.is_passable()) return kernel(at, d);  // as where a path meets it: `AfterEdge` holds on
    const Spectrum far = SceneEdges::far_enough(distance, false, beams_);
    return is_black(far) ? far : far * kernel(at, d);
  }
  Vec2 next2() { return {random_.next(), random_.next()}; }

private:
  /// A part of a light with the numbers that choose a point of it, and about where that is.
  struct LampEnd {
    const Light* light;
    std::size_t part;
    float probability;
    Vec2 u;
    float per_distance;  ///< one over that from edges
    const float* lit;    ///< LitEdges
    PathEnd guide{};     ///< see `find_guide`
  };
  Spectrum kernel(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o) {
    return edges_.kernel(point, d_i, d_o, beams_, next2());
  }
  /// Of the geometry between a place and an edge: 1/r^2 over the density, for wavelengths whose beams are
  /// small enough.
  Spectrum reach(const Place& from, const EdgePoint& point) const;
  /// 0 where it ends a path, else one over the probability that it does not.
  float roulette(float probability) {
    return probability == 1 || random_.next() < probability ? 1 / probability : 0;
  }
  /// Roulette that decides whether a path goes on to edges that it has chosen: always where they send no less
  /// than a part of the other light, else in proportion to what they send.
  float looked_at(const SceneEdges::EdgesBetween& edges, Beside beside) {
    if (beside == Beside::nothing) return 1;
    // Over direct light; that by way of surfaces has more noise.
    const float much = beside == Beside::direct ? 0.002f : 4 * scene_.diffraction()->light_in_shadows(),
                least = beside == Beside::direct ? 0.25f : 0.125f;
    return much > 0 ? roulette(std::clamp(edges.part_of_direct / much, least, 1.f)) : 1;
  }
  /// The same with that probability, but seldom to never: all looks cost the same, and those of faint paths
  /// add little.
  float looked_at(float left) {
    constexpr float kLeast = 0.05f;
    return roulette(std::clamp(left, kLeast, 1.f));
  }
  /// The same before an edge is chosen: where all edges together send little, wherever they are, most looks
  /// end here; not as many where that may be all the light there is.
  float looked_for(const Vec3& from, float end_per_distance, bool is_beside_direct) {
    constexpr float kMuch = 0.01f, kLeast = 1 / 64.f, kLeastInShadow = 1 / 8.f;
    const float near = SceneEdges::within_reach(beams_) / kMuch;
    const float most = SceneEdges::most_of_direct(edges_.per_distance(from, near), end_per_distance, beams_);
    return roulette(std::clamp(most / kMuch, is_beside_direct ? kLeast : kLeastInShadow, 1.f));
  }
  /// The same of light that the sensor sees at edges. All that is found adds up on the pixels that they fill,
  /// so that where these are few a part of the samples finds it with less noise than other light has.
  float looked_on_film();
  /// The same of paths that begin at an end of all paths and go to an edge.
  float begun_from(const Vec3& p) {
    return roulette(std::clamp(64 * edges_.seen_from(p, beams_), 1 / 16.f, 1.f));
  }
  /// All but its guide.
  bool choose_lamp(LampEnd& lamp);
  /// About where the lamp is, seen from a place: it guides the choice of an edge. False where there is none.
  bool find_guide(const Vec3& seen_from, LampEnd& lamp) const;
  /// Of an edge that is chosen by chance whether the sensor looks there.
  bool sees_some_edge(const Vec3& eye, Vec2 lens);
  Vec3 sensor_guide(const Vec3& seen_from, Vec2 lens) const;
  /// A place on an edge, after roulette (`looked_at`), by whose probability `whole` is divided. `lit`: of the
  /// end that is a lamp, or null.
  std::optional<EdgePoint> choose_between(const Vec3& a, const PathEnd& b, const float* lit, Beside beside,
                                          float& whole);
  Spectrum light_at(const Place& from, const EdgePoint& point, const Vec3& d, const LampEnd& lamp);
  Spectrum sensor_at(const Place& from, const EdgePoint& point, const Vec3& d, Vec2 lens, Vec2& film);
  /// The part of the light that goes straight from a place to an edge, black where something is in the way.
  /// `end` receives the flight there, in scenes with media.
  Spectrum passed_to_edge(const RayOrigin& from, LightWay::End from_end, const EdgePoint& point,
                          const RayState& surroundings, bool through_emitters, std::uint32_t key,
                          RayState* end, int& crossings_left) const;
  /// The part of the light that passes from a place to an edge and from there to `to`, which is `end` or at
  /// infinity.
  Spectrum through(const EdgePoint& point, const RayOrigin& from, LightWay::End from_end,
                   const RayState& surroundings, bool through_emitters, const PathEnd& to,
                   const RayOrigin* end, bool end_through_emitters);
  /// Light of the lamp that arrives at the edge along -wo, over the density of its choice.
  Spectrum lit(const EdgePoint& point, const LampEnd& lamp, RayOrigin& start, Vec3& wo, bool& infinite) const;
  bool arrive(const Place& from, const EdgePoint& point, const Vec3& d, bool through_emitters,
              Spectrum& value, AtEdge& out);

  const Scene& scene_;
  const SceneEdges& edges_;
  const Wavelengths& w_;
  const SceneEdges::Beams beams_;
  KeyedRandom random_;
  bool hide_emitters_;
  int crossings_allowed_ = kUnlimitedCrossings, crossings_left_ = kUnlimitedCrossings;
};

}  // namespace aureole
