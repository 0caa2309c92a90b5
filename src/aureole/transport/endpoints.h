// SPDX-License-Identifier: Apache-2.0
// The ends of paths: connections of a vertex with a light or with the sensor, and the density with which
// light sampling would have found a light that a path has met.
#pragma once

#include "aureole/core/keyed_random.h"
#include "aureole/transport/vertex.h"

namespace aureole {

/// How many samples of each kind there are at a vertex: connections with lights, directions of the BSDF.
struct SampleCounts {
  float light = 1, scatter = 1;
};

/// Chooses a light and a direction towards it for the vertex at the end of `path`, which `flight` has
/// led to, and sets the connection
/// with its unoccluded contribution. `key` is for random numbers on its way. `by_light`: the density, relative
/// to that of the path's hero, of ways to this vertex beside walking from which lights are connected as well;
/// null: there are none. False if it carries no light.
// Always inlined: numbers of samples of 1 cost nothing then.
template <Space kSpace>
[[gnu::always_inline]] inline bool connect_to_light(const Scene& scene, const BasicVertex<kSpace>& vertex,
                                                    const Flight& flight, const PathDensity& path, float u1,
                                                    Vec2 u2, const Wavelengths& w, SampleCounts counts,
                                                    std::uint32_t key, Connection& out,
                                                    const Spectrum* by_light = nullptr) {
  const Vec3 facing = vertex.facing();
  const auto choice = scene.lights().choose(vertex.p(), facing, u1);
  if (!choice || !(choice->probability > 0)) return false;
  const auto direct = choice->light->sample_direct_facing(vertex.p(), facing, choice->part, u2, w);
  if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) return false;
  Response response;
  if (!vertex.respond(direct->wo, response)) return false;
  const Spectrum other = direct->delta ? Spectrum(0.f) : response.pdf * counts.scatter;
  const float own = choice->probability * direct->pdf * counts.light;
  if (direct->infinite)
    out.set(vertex.anchor().leave(direct->wo));
  else
    out.set(vertex.anchor(), direct->wo, Anchor::of(*direct));
  if (kSpace == Space::any && scene.has_media()) {
    out.begin_in(vertex.surroundings(direct->wo, flight), key);
    out.own = (by_light ? path.ratio + *by_light : path.ratio) * own, out.other = path.ratio * other;
    out.light = path.beta.of(response.value.of(direct->radiance)) / w.pdf;
  } else {
    out.light = path.connected(response.value, direct->radiance, own, other, w);
  }
  return true;
}

/// The media for whose emission connections look, or null.
inline const EmittingMedia* connected_media(const Scene& scene) {
  const EmittingMedia* media = scene.emitting_media();
  return media && media->can_be_connected() ? media : nullptr;
}

/// As `connect_to_light`, for a place in a medium that emits: `u1` chooses the medium, `u2` is for the place.
inline bool connect_to_emission(const Scene& scene, const Vertex& vertex, const Flight& flight,
                                const PathDensity& path, float u1, Vec2 u2, const Wavelengths& w,
                                SampleCounts counts, std::uint32_t key, Connection& out) {
  const EmittingMedia& media = *scene.emitting_media();
  KeyedRandom random(key);
  EmittingMedia::Place place;
  if (!media.sample(vertex.p(), vertex.facing(), u1, u2, random.next(), place)) return false;
  const Vec3 to = place.p - vertex.p();
  const float d2 = length_squared(to);
  if (!(d2 > 0)) return false;
  const Vec3 d = to * (1 / std::sqrt(d2));
  MediumCoefficients at;
  place.medium->eval(place.p, d, w, at);
  Response response;
  if (is_black(at.emission) || !vertex.respond(d, response)) return false;
  const float rate =
      emission_rate(*place.medium, place.p, d, at.sigma_t, media.inverse_size(*place.medium), w);
  if (!(rate > 0)) return false;  // outside of the medium's box
  out.set(vertex.anchor(), d, Anchor::in_space(place.p));
  out.begin_in(vertex.surroundings(d, flight), key + 1);
  out.source = place.medium;
  out.own = path.ratio * (place.pdf * d2 * counts.light);
  out.other = path.ratio * response.pdf * (rate * counts.scatter);
  out.light = path.beta.of(response.value.of(at.emission)) / w.pdf;
  return true;
}

/// The density with which `connect_to_light` would have chosen `point` of a part of the light or, that being null,
/// infinity along `d`.
inline float light_density(const Scene& scene, const LightReference& from, const Light& light,
                           std::size_t part, const SurfacePoint* point, const Vec3& d) {
  return scene.lights().probability(from.p, from.facing, light, part) *
         (point ? light.pdf_direct(from.p, part, *point) : light.pdf_direct_escaped(from.p, from.facing, d));
}
/// The same of a point that a ray has met.
inline float light_density(const Scene& scene, const LightReference& from, const Light& light,
                           const SurfacePoint* point, const Vec3& d) {
  return light_density(scene, from, light, point ? light.part_of(*point) : 0, point, d);
}

/// Connects the vertex at the end of a path of light with the sensor, where it is seen at `film`. False where
/// it is not, or no light goes there.
inline bool connect_to_sensor(const Scene& scene, const Vertex& vertex, const Flight& flight,
                              const LightPathDensity& path, Vec2 lens, const Wavelengths& w,
                              std::uint32_t key, Connection& out, Vec2& film) {
  const auto seen = scene.sensor().sample_direct(vertex.p(), lens);
  if (!seen || !(seen->importance > 0)) return false;
  if (!vertex.is_surface() && !scene.may_see(*flight.medium, seen->p)) return false;
  Response response;
  if (!vertex.respond(seen->wo, response)) return false;
  out.light = path.reached(response.value, seen->importance, w);
  out.set(vertex.anchor(), seen->wo, Anchor::in_space(seen->p));
  if (scene.has_media()) {
    out.begin_in(vertex.surroundings(seen->wo, flight), key);
    out.own = 1.f / kWavelengths, out.other = 0.f;  // there is no other technique
  }
  film = seen->film;
  return true;
}

}  // namespace aureole
