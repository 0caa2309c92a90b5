// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/edges.h"

#include "aureole/scene/edge/lit_edges.h"
#include "aureole/scene/edge/seen_edges.h"

namespace aureole {

namespace {

/// Returns the state of a ray that leaves a vertex along d, which only scenes with media need.
RayState leaving(const Scene& scene, const EdgePaths::Place& from, const Vec3& d) {
  return scene.has_media() ? from.leaving(d) : RayState{};
}

/// Returns transmittance times diffraction factor of a segment that begins or ends at an edge; `end` receives
/// the ray state at its far endpoint.
Spectrum passed_along(const Scene& scene, TestSegment& c, LightWay::End begin, LightWay::End finish,
                      const Wavelengths& w, const RayState& start, std::uint32_t key, RayState* end,
                      int& crossings_left) {
  if (scene.has_media()) c.begin_in(start, key);
  c.crossings_left = crossings_left;
  c.own = 1.f / kWavelengths, c.other = 0.f;  // no other technique finds this segment
  c.passage = 1.f;
  if (!is_visible(scene, c, w)) return 0.f;
  crossings_left = c.crossings_left;
  if (end) *end = c;
  c.passage *= left_by_edges(scene, LightWay::of(c, begin, finish), w, key + 2);
  return c.passage;
}

constexpr auto kVertex = LightWay::End::vertex, kEdge = LightWay::End::edge;

TestSegment between(const RayOrigin& from, const RayOrigin& to, bool through_emitters) {
  TestSegment c;
  c.set(from, normalize(to.p - from.p), to);
  c.through_emitters = through_emitters;
  return c;
}

}  // namespace

Spectrum EdgePaths::passed_to_edge(const RayOrigin& from, LightWay::End from_end, const EdgePoint& point,
                                   const RayState& surroundings, bool through_emitters, std::uint32_t key,
                                   RayState* end, int& crossings_left) const {
  const RayOrigin edge = RayOrigin::in_space(point.p);
  // Rays are traced from the edge, where the ray tracer's rounding error refers to the faces there and not to
  // the segment's length. In scenes with media they are traced from the vertex, since the media are known
  // there.
  TestSegment c =
      scene_.has_media() ? between(from, edge, through_emitters) : between(edge, from, through_emitters);
  return passed_along(scene_, c, scene_.has_media() ? from_end : kEdge, scene_.has_media() ? kEdge : from_end,
                      w_, surroundings, key, end, crossings_left);
}

Spectrum EdgePaths::reach(const Place& from, const EdgePoint& point) const {
  const float d2 = length_squared(point.on_edge() - from.origin.p);
  if (!(d2 > 0)) return 0.f;
  return SceneEdges::far_enough(std::sqrt(d2), !from.vertex, beams_) * (1 / (point.pdf * d2));
}

bool EdgePaths::choose_lamp(LampEnd& lamp) {
  const auto choice = scene_.lights().choose_by_power(next2(), w_.time);
  if (!choice || !(choice->probability > 0)) return false;
  lamp.light = choice->light, lamp.part = choice->part, lamp.probability = choice->probability;
  lamp.u = next2();
  if (const LitEdges::Lamp* known = scene_.diffraction()->lit_edges().from(*lamp.light, lamp.part))
    lamp.lit = known->lit.data(), lamp.per_distance = 1 / known->nearest;
  else
    lamp.lit = nullptr,
    lamp.per_distance = lamp.light->is_infinite()
                            ? 0.f
                            : edges_.per_distance(lamp.light->emission_bounds(lamp.part).box.center(), 0);
  return true;
}

bool EdgePaths::find_guide(const Vec3& seen_from, LampEnd& lamp) const {
  // The point of the light is sampled again from the edge's position, with the same numbers.
  const auto end = lamp_end(*lamp.light, lamp.part, lamp.u, seen_from, w_);
  if (end) lamp.guide = *end;
  return end.has_value();
}

Vec3 EdgePaths::sensor_guide(const Vec3& seen_from, Vec2 lens) const {
  if (const auto seen = scene_.sensor().sample_direct(seen_from, lens)) return seen->p;
  const FilmPart& part = scene_.sensor().part;
  return scene_.sensor().sample_ray(0.5f * (part.lower + part.upper), lens).ray.o;
}

std::optional<EdgePoint> EdgePaths::choose_between(const Vec3& a, const PathEnd& b, const float* lit,
                                                   Beside beside, float& whole) {
  const float of_edges[2] = {random_.next(), random_.next()};
  const auto edges = edges_.choose_between(PathEnd{a}, b, beams_, of_edges, lit);
  if (!edges) return {};
  whole *= looked_at(*edges, beside);
  if (whole == 0) return {};
  const float of_place[2] = {random_.next(), random_.next()};
  const EdgePoint point = edges_.place_between(*edges, PathEnd{a}, b, beams_, of_place);
  return point.pdf > 0 && point.on_edge() != a ? std::optional(point) : std::nullopt;
}

Spectrum EdgePaths::lit(const EdgePoint& point, const LampEnd& lamp, RayOrigin& start, Vec3& wo,
                        bool& infinite) const {
  const auto s = lamp.light->sample_direct(point.on_edge(), lamp.part, lamp.u, w_);
  if (!s || !(s->pdf > 0)) return 0.f;
  start = RayOrigin::of(*s), infinite = s->infinite;
  wo = infinite ? s->wo : -point.direction_from(s->p);
  return s->radiance * (1 / (s->pdf * lamp.probability));
}

Spectrum EdgePaths::through(const EdgePoint& point, const RayOrigin& from, LightWay::End from_end,
                            const RayState& surroundings, bool through_emitters, const PathEnd& to,
                            const RayOrigin* end, bool end_through_emitters) {
  const std::uint32_t key = std::uint32_t(random_.next() * 0x1p31f);
  const RayOrigin origin = RayOrigin::in_space(point.p);
  RayState at_edge;
  int left = crossings_left_;  // copy of the number of crossings, since the path itself does not move
  const Spectrum passed =
      passed_to_edge(from, from_end, point, surroundings, through_emitters, key, &at_edge, left);
  if (is_black(passed)) return 0.f;
  TestSegment c;
  if (to.is_infinite)
    c.set(origin.spawn(to.p));
  else
    c = between(origin, *end, end_through_emitters);
  return passed * passed_along(scene_, c, kEdge, kVertex, w_, at_edge, key + 1, nullptr, left);
}

Spectrum EdgePaths::light_at(const Place& from, const EdgePoint& point, const Vec3& d, const LampEnd& lamp) {
  RayOrigin start;
  Vec3 wo;
  bool infinite;
  Spectrum value = lit(point, lamp, start, wo, infinite);
  // The order is by cost: the kernel is the most expensive factor, and most segments are occluded.
  if (is_black(value) || !SceneEdges::turns_around(point, d, wo)) return 0.f;
  value *= reach(from, point);
  if (is_black(value)) return 0.f;
  value *=
      through(point, from.origin, from.end(), leaving(scene_, from, d), false, {wo, infinite}, &start, false);
  return is_black(value) ? value : value * kernel(point, d, wo);
}

Spectrum EdgePaths::sensor_at(const Place& from, const EdgePoint& point, const Vec3& d, Vec2 lens,
                              Vec2& film) {
  const auto seen = scene_.sensor().sample_direct(point.on_edge(), lens);
  if (!seen || !(seen->importance > 0) || !SceneEdges::turns_around(point, d, seen->wo)) return 0.f;
  film = seen->film;
  Spectrum value = reach(from, point) * seen->importance;
  if (is_black(value)) return 0.f;
  const RayOrigin aperture = RayOrigin::in_space(seen->p);
  value *=
      through(point, from.origin, from.end(), leaving(scene_, from, d), false, {}, &aperture, hide_emitters_);
  return is_black(value) ? value : value * kernel(point, d, seen->wo);
}

bool EdgePaths::sees_some_edge(const Vec3& eye, Vec2 lens) {
  const float u[3] = {random_.next(), random_.next(), random_.next()};
  const auto point = edges_.choose_from({eye}, u);
  const auto seen = point ? scene_.sensor().sample_direct(point->on_edge(), lens) : std::nullopt;
  return seen && seen->importance > 0;
}

float EdgePaths::looked_on_film() {
  constexpr float kPerPart = 8, kLeast = 1 / 16.f;
  return roulette(std::clamp(kPerPart * scene_.diffraction()->seen_edges().film_part(), kLeast, 1.f));
}

Spectrum EdgePaths::from_light_to_sensor(Vec2 lens, Vec2& film) {
  // A point of the aperture that guides the choice of the edge; `lens` samples the actual point again from
  // the edge's position.
  const Vec3 eye = sensor_guide(scene_.bounds().center(), lens);
  float part = looked_on_film();
  LampEnd lamp;
  if (part == 0 || !choose_lamp(lamp)) return 0.f;
  part *= looked_for(eye, lamp.per_distance, true);
  if (part == 0 || !find_guide(eye, lamp)) return 0.f;
  // Probability of sampling other edges than those that the sensor is known to see.
  constexpr float kOthers = 0.25f;
  std::optional<EdgePoint> point;
  if (const SeenEdges::Table* table = scene_.diffraction()->seen_edges().from(*lamp.light, lamp.part, lens)) {
    if (random_.next() >= kOthers) {
      if (table->edges.empty()) return 0.f;
      part *= 1 / (1 - kOthers);
      const float u[3] = {random_.next(), random_.next(), random_.next()};
      const SeenEdges::Table::Choice choice = table->choose(edges_, PathEnd{eye}, lamp.guide, beams_, u[0]);
      point = edges_.place_between(edges_.index().edges()[choice.edge], choice.probability, PathEnd{eye},
                                   lamp.guide, beams_, u + 1);
    } else {
      part *= 1 / kOthers;
      point = choose_between(eye, lamp.guide, lamp.lit, Beside::nothing, part);
      if (point && table->has(edges_.index().number(*point->edge))) return 0.f;
    }
  } else {
    if (!sees_some_edge(eye, lens)) {
      if (random_.next() >= kOthers) return 0.f;
      part *= 1 / kOthers;
    }
    point = choose_between(eye, lamp.guide, lamp.lit, Beside::nothing, part);
  }
  if (!point || !(point->pdf > 0)) return 0.f;
  const auto seen = scene_.sensor().sample_direct(point->on_edge(), lens);
  if (!seen || !(seen->importance > 0)) return 0.f;
  film = seen->film;
  RayOrigin start;
  Vec3 wo;
  bool infinite;
  Spectrum value = lit(*point, lamp, start, wo, infinite);
  if (is_black(value) || !SceneEdges::turns_around(*point, -wo, seen->wo)) return 0.f;
  value *= part * seen->importance / point->pdf;
  RayState from_sensor{Ray{seen->p, -seen->wo, kInfinity}, nullptr, {}};
  if (scene_.has_media()) find_interiors(scene_, nullptr, from_sensor);
  value *= through(*point, RayOrigin::in_space(seen->p), kVertex, from_sensor, hide_emitters_, {wo, infinite},
                   &start, false);
  return is_black(value) ? value : value * kernel(*point, -wo, seen->wo);
}

bool EdgePaths::arrive(const Place& from, const EdgePoint& point, const Vec3& d, bool through_emitters,
                       Spectrum& value, AtEdge& out) {
  const std::uint32_t key = std::uint32_t(random_.next() * 0x1p31f);
  value *= passed_to_edge(from.origin, from.end(), point, leaving(scene_, from, d), through_emitters, key,
                          &out.state, crossings_left_);
  out.point = point, out.d = d;
  return !is_black(value);
}

bool EdgePaths::begin_at_sensor(Vec2 lens, Spectrum& value, AtEdge& out, Vec2& film) {
  // A point of the aperture that guides the choice of the edge; `lens` samples the actual point again from
  // the edge's position.
  const Vec3 eye = sensor_guide(scene_.bounds().center(), lens);
  const float begins = begun_from(eye);
  if (begins == 0) return false;
  const float u[3] = {random_.next(), random_.next(), random_.next()};
  const auto point = edges_.choose_from({eye}, u);
  if (!point || !(point->pdf > 0)) return false;
  const auto seen = scene_.sensor().sample_direct(point->on_edge(), lens);
  if (!seen || !(seen->importance > 0)) return false;
  film = seen->film;
  value = seen->importance * begins / point->pdf;
  RayState start{Ray{seen->p, -seen->wo, kInfinity}, nullptr, {}};
  if (scene_.has_media()) find_interiors(scene_, nullptr, start);
  return arrive({RayOrigin::in_space(seen->p), &start}, *point, -seen->wo, hide_emitters_, value, out);
}

bool EdgePaths::begin_at_light(Spectrum& value, AtEdge& out) {
  LampEnd lamp;
  if (!choose_lamp(lamp) || !find_guide(scene_.bounds().center(), lamp)) return false;
  const float begins = lamp.guide.is_infinite ? 1.f : begun_from(lamp.guide.p);
  if (begins == 0) return false;
  const float u[3] = {random_.next(), random_.next(), random_.next()};
  const auto point = edges_.choose_from(lamp.guide, u, nullptr, lamp.lit);
  if (!point || !(point->pdf > 0)) return false;
  RayOrigin start;
  Vec3 wo;
  bool infinite;
  value = lit(*point, lamp, start, wo, infinite) * (begins / point->pdf);
  if (is_black(value)) return false;
  out.point = *point, out.d = -wo;
  const std::uint32_t key = std::uint32_t(random_.next() * 0x1p31f);
  const RayOrigin origin = RayOrigin::in_space(point->p);
  // The segment is traced from the edge to the light: its transmittance is equal in both directions, and
  // lights at infinity have no point at which a ray could begin.
  out.state = RayState{Ray{point->p, wo, kInfinity}, nullptr, {}};
  if (scene_.has_media()) find_interiors(scene_, out.state);
  TestSegment c;
  if (infinite)
    c.set(origin.spawn(wo));
  else
    c = between(origin, start, false);
  value *= passed_along(scene_, c, kEdge, kVertex, w_, out.state, key, nullptr, crossings_left_);
  return !is_black(value);
}

bool EdgePaths::scatter(const AtEdge& at, Spectrum& value, Vec3& d, float& pdf) {
  const float u[4] = {random_.next(), random_.next(), random_.next(), random_.next()};
  const auto direction = edges_.scatter(at.point, at.d, beams_, u);
  if (!direction) return false;
  d = direction->d, pdf = direction->pdf;
  value *= kernel(at, d) * (1 / pdf);
  return !is_black(value);
}

}  // namespace aureole
