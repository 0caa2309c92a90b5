// SPDX-License-Identifier: Apache-2.0
// Paths around edges that diffract light (docs/diffraction_beams.md). A point on an edge is a path vertex without
// area, at which the kernel of `SceneEdges` scatters light.
//
// Each point on an edge is sampled by one technique only. An edge vertex next to the path's far endpoint (a
// light in `path`, `direct` and `bdpt`, the sensor in `ptracer`) is sampled for its two neighbours, like the
// endpoint of a connection. Other edge vertices are sampled by a walk: it leaves its vertex for an edge with
// the probability `to_edge`, and continues behind the edge by the edge's kernel. The weights of `bdpt` for
// the rest of such paths are in integrator/bdpt/subpath.h.
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

/// State of a path that has left an edge, until it arrives at a vertex.
struct AfterEdge {
  Vec3 edge;
  bool is_set = false;
  float pdf = 0;  ///< pdf with which the direction was sampled [1/sr]
  // State of light paths of `bdpt`:
  /// whether the path's last edge is sampled from the sensor, so that its vertices are not connected
  bool found_from_sensor = false;
  bool is_next = false;  ///< whether the vertex before the present one is an edge
  /// Whether the ray went on behind an obstacle, for light paths with the diffraction model "segments".
  bool is_behind = false;
  /// no edges lie near the present ray (`has_edges_near`)
  bool is_clear = false;
  /// Whether the present segment comes from a light at infinity, with the diffraction model "segments".
  bool begins_at_infinity = false;

  /// Returns the kind of the endpoint at which the path's present segment begins.
  LightWay::End end() const { return is_set ? LightWay::End::edge : LightWay::End::vertex; }

  /// Zeroes, at a vertex, the wavelengths whose beam around the edge contains `p`. Returns false if no
  /// wavelength is left.
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
  /// Probability of leaving a vertex for an edge, small where edges are far or beams narrow.
  static float to_edge(const Scene& scene, const Vec3& p, const Wavelengths& w) {
    return std::clamp(8 * scene.diffraction()->edges().seen_from(p, scene.diffraction()->edges().beams(w)),
                      1 / 64.f, 0.25f);
  }

  EdgePaths(const Scene& scene, const Wavelengths& w, std::uint32_t key, bool hide_emitters = false)
      : EdgePaths(scene, w, KeyedRandom(key), hide_emitters) {}
  /// Takes `random` in its present state, from which numbers may have been drawn.
  EdgePaths(const Scene& scene, const Wavelengths& w, const KeyedRandom& random, bool hide_emitters = false)
      : scene_(scene),
        edges_(scene.diffraction()->edges()),
        w_(w),
        beams_(edges_.beams(w)),
        random_(random),
        hide_emitters_(hide_emitters) {}

  /// Sets how many surfaces the path may cross from here on that count for the limit of segments; initially
  /// there is no limit.
  void limit_crossings(int left) { crossings_allowed_ = crossings_left_ = left; }
  /// Returns the number of counted surfaces that the path has crossed between edges since the last call.
  int take_crossed() { return std::exchange(crossings_allowed_, crossings_left_) - crossings_left_; }

  /// A path vertex from or to which light is diffracted by an edge: a vertex of the scene or another edge.
  struct Place {
    RayOrigin origin;
    const RayState* state;           ///< state of the ray that led there, or that leaves an edge
    const Vertex* vertex = nullptr;  ///< the vertex; null: an edge

    LightWay::End end() const { return vertex ? LightWay::End::vertex : LightWay::End::edge; }
    RayState leaving(const Vec3& d) const { return vertex ? vertex->leaving(d, *state) : *state; }
  };
  static Place at_vertex(const Vertex& vertex, const RayState& state) {
    return {vertex.origin(), &state, &vertex};
  }
  /// Returns the response of a vertex in a direction to light of 1 at all wavelengths.
  static Spectrum response(const Vertex& vertex, const Vec3& d) {
    Response r;
    return vertex.respond(d, r) ? r.value.of(1.f) : Spectrum(0.f);
  }
  /// A path at an edge: the point on the edge, and the direction of travel of the path that arrived there.
  struct AtEdge {
    EdgePoint point;
    Vec3 d;
    RayState state;  ///< state at the edge, without a ray

    Place place() const { return {RayOrigin::in_space(point.p), &state}; }
  };

  /// Kind of the other light at a vertex, relative to which diffracted light is sampled with a lower
  /// probability: none, unoccluded light of an emitter, or light scattered by surfaces into shadows.
  enum class Beside : std::uint8_t { nothing, direct, surfaces };

  /// Returns the light of an emitter that reaches `from` around one edge, scattered there by respond(d) ->
  /// Spectrum, with d the direction to the edge; black where there is none. `left` is approximately the
  /// path's relative throughput, the probability of sampling this light.
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
  /// Returns the sensor's response to light that leaves `from` with respond(d) and is diffracted by one edge,
  /// seen at `film`. `is_seen`: the sensor also sees `from` directly.
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
  /// Returns the sensor's response to light of an emitter that is diffracted by one edge. Russian roulette
  /// lowers the number of samples where the sensor does not see a randomly chosen edge.
  Spectrum from_light_to_sensor(Vec2 lens, Vec2& film);

  /// Continues a path from a vertex to an edge; false where the edge is occluded. `value` is multiplied by
  /// the arriving light over the pdf.
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
  /// Continues a path from a vertex that it leaves for an edge with the given probability, otherwise as
  /// above.
  bool walk(const Vertex& vertex, const RayState& state, float probability, Spectrum& value, AtEdge& out) {
    value = 1 / probability;
    return walk(
        at_vertex(vertex, state), [&](const Vec3& d) { return response(vertex, d); }, value, out);
  }
  /// Continues a path from an edge, which it has reached with the factor `value`, possibly by way of other
  /// edges, into a direction. `density`, `state` and `after` become those of the path behind the edge.
  /// `scattered` counts the path's vertices, one for each edge. reaches(n) returns whether paths of n edges
  /// count; it is called before each step, so that it may limit crossings. see(at, value) connects every edge
  /// with the path's far endpoint. Returns false where the path ends.
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
  /// Samples the first edge of a path from the sensor, seen at `film`.
  bool begin_at_sensor(Vec2 lens, Spectrum& value, AtEdge& out, Vec2& film);
  /// Samples the first edge of a path from a light.
  bool begin_at_light(Spectrum& value, AtEdge& out);

  /// Samples a direction behind the edge; `value` is multiplied by the kernel over the pdf. Returns false
  /// where the path ends.
  bool scatter(const AtEdge& at, Spectrum& value, Vec3& d, float& pdf);
  float scatter_pdf(const AtEdge& at, const Vec3& d) const {
    return edges_.scatter_pdf(at.point, at.d, d, beams_);
  }

  /// Returns an estimate of the edge's kernel, with random numbers of the path.
  Spectrum kernel(const AtEdge& at, const Vec3& d) { return kernel(at.point, at.d, d); }
  /// Returns K between an edge that a path has reached and a vertex of another path, at `distance` from the
  /// edge; 0 where the vertex lies in the edge's beam.
  Spectrum kernel_to(const AtEdge& at, const Vec3& d, const Vertex& vertex, float distance) {
    // as for a path that hits a null surface, behind which `AfterEdge` remains set
    if (vertex.is_passable()) return kernel(at, d);
    const Spectrum far = SceneEdges::far_enough(distance, false, beams_);
    return is_black(far) ? far : far * kernel(at, d);
  }
  Vec2 next2() { return {random_.next(), random_.next()}; }

private:
  /// A part of a light, the random numbers that choose a point on it, and its approximate position.
  struct LampEnd {
    const Light* light;
    std::size_t part;
    float probability;
    Vec2 u;
    float per_distance;  ///< bound of the inverse distance between the light and edges
    const float* lit;    ///< table LitEdges of the light, or null
    PathEnd guide{};     ///< approximate position, set by `find_guide`
  };
  Spectrum kernel(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o) {
    return edges_.kernel(point, d_i, d_o, beams_, next2());
  }
  /// Geometry factor 1/r^2 between a vertex and an edge, over the pdf of the edge's point. It is zero at
  /// wavelengths whose beams are too wide for the distance.
  Spectrum reach(const Place& from, const EdgePoint& point) const;
  /// Russian roulette: returns 0 where it ends a path, else one over the survival probability.
  float roulette(float probability) {
    return probability == 1 || random_.next() < probability ? 1 / probability : 0;
  }
  /// Russian roulette for paths to edges that have been chosen: survival is certain where the edges send at
  /// least a certain fraction of the other light, else it is in proportion to that fraction.
  float looked_at(const SceneEdges::EdgesBetween& edges, Beside beside) {
    if (beside == Beside::nothing) return 1;
    // Fraction of the other light, where direct light has a lower threshold than light scattered by surfaces,
    // which has more noise.
    const float much = beside == Beside::direct ? 0.002f : 4 * scene_.diffraction()->light_in_shadows(),
                least = beside == Beside::direct ? 0.25f : 0.125f;
    return much > 0 ? roulette(std::clamp(edges.part_of_direct / much, least, 1.f)) : 1;
  }
  /// Russian roulette on relative throughput, survival at least 5 %: every visibility test costs the same.
  float looked_at(float left) {
    constexpr float kLeast = 0.05f;
    return roulette(std::clamp(left, kLeast, 1.f));
  }
  /// Russian roulette before an edge is chosen: low survival where all edges together can send little light,
  /// but not as low in shadows, where diffracted light may be the only light.
  float looked_for(const Vec3& from, float end_per_distance, bool is_beside_direct) {
    constexpr float kMuch = 0.01f, kLeast = 1 / 64.f, kLeastInShadow = 1 / 8.f;
    const float near = SceneEdges::within_reach(beams_) / kMuch;
    const float most = SceneEdges::most_of_direct(edges_.per_distance(from, near), end_per_distance, beams_);
    return roulette(std::clamp(most / kMuch, is_beside_direct ? kLeast : kLeastInShadow, 1.f));
  }
  /// Russian roulette for light that the sensor sees directly at edges. This light accumulates on the pixels
  /// that the edges cover; where these are few, a fraction of the samples has less noise than other light.
  float looked_on_film();
  /// Russian roulette for paths that begin at an endpoint and continue to an edge.
  float begun_from(const Vec3& p) {
    return roulette(std::clamp(64 * edges_.seen_from(p, beams_), 1 / 16.f, 1.f));
  }
  /// Sets all members of `lamp` except its guide.
  bool choose_lamp(LampEnd& lamp);
  /// Sets the approximate position of the light as seen from a point, which guides the choice of an edge.
  /// Returns false where there is none.
  bool find_guide(const Vec3& seen_from, LampEnd& lamp) const;
  /// Whether the sensor sees a randomly chosen edge.
  bool sees_some_edge(const Vec3& eye, Vec2 lens);
  Vec3 sensor_guide(const Vec3& seen_from, Vec2 lens) const;
  /// Samples a point on an edge, after Russian roulette (`looked_at`), by whose survival probability `whole`
  /// is divided. `lit` is the table of the endpoint that is a light, or null.
  std::optional<EdgePoint> choose_between(const Vec3& a, const PathEnd& b, const float* lit, Beside beside,
                                          float& whole);
  Spectrum light_at(const Place& from, const EdgePoint& point, const Vec3& d, const LampEnd& lamp);
  Spectrum sensor_at(const Place& from, const EdgePoint& point, const Vec3& d, Vec2 lens, Vec2& film);
  /// Returns the transmittance from a vertex to an edge, black where the segment is occluded. `end` receives
  /// the ray state at the edge, in scenes with media.
  Spectrum passed_to_edge(const RayOrigin& from, LightWay::End from_end, const EdgePoint& point,
                          const RayState& surroundings, bool through_emitters, std::uint32_t key,
                          RayState* end, int& crossings_left) const;
  /// Returns the transmittance from a vertex to an edge and from there to `to`, which is `end` or at
  /// infinity.
  Spectrum through(const EdgePoint& point, const RayOrigin& from, LightWay::End from_end,
                   const RayState& surroundings, bool through_emitters, const PathEnd& to,
                   const RayOrigin* end, bool end_through_emitters);
  /// Returns the light of an emitter that arrives at the edge along -wo, over the pdf of the sampled point.
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
