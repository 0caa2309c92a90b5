// SPDX-License-Identifier: Apache-2.0
// Next-event estimation: connections of a vertex with a light, with emission of a medium, or with the sensor;
// and the pdf with which light sampling would have found a light that a path has hit.
#pragma once

#include <optional>

#include "aureole/core/keyed_random.h"
#include "aureole/transport/vertex.h"

namespace aureole {

/// Number of samples of each kind at a vertex: connections with lights, directions of the BSDF.
struct SampleCounts {
  float light = 1, scatter = 1;
};

/// A light that was chosen for a vertex, and a direction towards it.
struct LightSample {
  LightChoice choice{};
  std::optional<DirectSample> direct;

  /// Whether light arrives along the direction.
  bool has_light() const { return direct && direct->pdf > 0 && !is_black(direct->radiance); }
};

/// Chooses a light by `u1` and a direction towards it by `u2`, for a point that receives light on the side of
/// `facing` (zero: on all sides).
[[gnu::always_inline]] inline LightSample sample_light(const Scene& scene, const Vec3& p, const Vec3& facing,
                                                       float u1, Vec2 u2, const Wavelengths& w) {
  const auto choice = scene.lights().choose(p, facing, u1, w.time);
  if (!choice || !(choice->probability > 0)) return {};
  return {*choice, choice->light->sample_direct_facing(p, facing, choice->part, u2, w)};
}

/// Sets the connection of the vertex at the end of a path, to which `state` has led, with the light of
/// `sample`. `beta`: throughput of the path. pdfs(choice, direct, response, own, other) gives the pdfs,
/// relative to the hero's pdf of the path, of this connection and of all other techniques that find the same
/// path. `key` is for random numbers along the connection. False where it carries no light.
template <Space kSpace, class L, class Pdfs>
[[gnu::always_inline]] inline bool connect_to_light(const Scene& scene, const BasicVertex<kSpace, L>& vertex,
                                                    const LightSample& sample, const RayState& state,
                                                    const typename L::Weight& beta, const Wavelengths& w,
                                                    std::uint32_t key, BasicConnection<L>& out, Pdfs&& pdfs) {
  if (!sample.has_light()) return false;
  const DirectSample& direct = *sample.direct;
  BasicResponse<L> response;
  if (!vertex.respond(direct.wo, response)) return false;
  if (direct.infinite)
    out.set(vertex.origin(), direct.wo);
  else
    out.set(vertex.origin(), direct.wo, RayOrigin::of(direct));
  out.near = beta.after(response.value);
  out.far = L::emitted(direct.radiance);
  Spectrum own, other;
  pdfs(sample.choice, direct, response, own, other);
  const bool has_media = kSpace == Space::any && scene.has_media();
  if (has_media) out.begin_in(vertex.leaving(direct.wo, state), key);
  out.weigh(has_media, own, other, w);
  return true;
}

/// Light sampling beside BSDF sampling. `r_equiangular`: the pdf, relative to the hero's pdf of the path, of
/// finding this vertex by a technique beside the walk that connects it with lights as well; null: there is
/// none.
template <Space kSpace, class L>
[[gnu::always_inline]] inline bool connect_to_light(const Scene& scene, const BasicVertex<kSpace, L>& vertex,
                                                    const LightSample& sample, const RayState& state,
                                                    const BasicPathDensity<L, PathStart::sensor>& path,
                                                    const Wavelengths& w, SampleCounts counts,
                                                    std::uint32_t key, BasicConnection<L>& out,
                                                    const Spectrum* r_equiangular = nullptr) {
  return connect_to_light(scene, vertex, sample, state, path.beta, w, key, out,
                          [&](const LightChoice& choice, const DirectSample& direct,
                              const BasicResponse<L>& response, Spectrum& own, Spectrum& other) {
                            own = (r_equiangular ? path.r_u + *r_equiangular : path.r_u) *
                                  (choice.probability * direct.pdf * counts.light);
                            other = direct.delta ? Spectrum(0.f) : path.r_u * response.pdf * counts.scatter;
                          });
}

/// The media whose emission next-event estimation samples, or null.
inline const EmittingMedia* connected_media(const Scene& scene) {
  const EmittingMedia* media = scene.emitting_media();
  return media && media->can_be_connected() ? media : nullptr;
}

/// Connects with a position in a medium that emits, otherwise as `connect_to_light`: `u1` chooses the medium,
/// `u2` is for the position.
template <class L>
bool connect_to_emission(const Scene& scene, const BasicVertex<Space::any, L>& vertex, const RayState& state,
                         const BasicPathDensity<L, PathStart::sensor>& path, float u1, Vec2 u2,
                         const Wavelengths& w, SampleCounts counts, std::uint32_t key,
                         BasicConnection<L>& out) {
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
  BasicResponse<L> response;
  if (is_black(at.emission) || !vertex.respond(d, response)) return false;
  const float rate =
      emission_rate(*place.medium, place.p, d, at.sigma_t, media.inverse_size(*place.medium), w);
  if (!(rate > 0)) return false;  // the position lies outside of the medium's box
  out.set(vertex.origin(), d, RayOrigin::in_space(place.p));
  out.begin_in(vertex.leaving(d, state), key + 1);
  out.source = place.medium;
  out.near = path.beta.after(response.value);
  out.far = L::emitted(at.emission);
  out.weigh(true, path.r_u * (place.pdf * d2 * counts.light),
            path.r_u * response.pdf * (rate * counts.scatter), w);
  return true;
}

/// The pdf with which `sample_light` would have chosen `point` of a part of the light or, that being
/// null, infinity along `d`, on a path of that time [s].
inline float light_density(const Scene& scene, const LightReference& from, const Light& light,
                           std::size_t part, const SurfacePoint* point, const Vec3& d, float time) {
  return scene.lights().probability(from.p, from.facing, light, part, time) *
         (point ? light.pdf_direct(from.p, part, *point) : light.pdf_direct_escaped(from.p, from.facing, d));
}
/// The pdf with which `sample_light` would have chosen a point that a ray has hit, or infinity.
inline float light_density(const Scene& scene, const LightReference& from, const Light& light,
                           const SurfacePoint* point, const Vec3& d, float time) {
  return light_density(scene, from, light, point ? light.part_of(*point) : 0, point, d, time);
}

/// Connects the vertex at the end of a light path of throughput `beta` with the sensor, where it is seen at
/// `film`. pdfs(seen, response, own, other) is as in `connect_to_light`, and returns false where the
/// connection has no pdf. Returns false where the vertex is not on the film, or scatters no light to the
/// sensor.
template <class L, class Pdfs>
bool connect_to_sensor(const Scene& scene, const BasicVertex<Space::any, L>& vertex, const RayState& state,
                       const typename L::Light& beta, Vec2 lens, bool hide_emitters, const Wavelengths& w,
                       std::uint32_t key, BasicConnection<L>& out, Vec2& film, Pdfs&& pdfs) {
  // Rays of the sensor pass through the surfaces of lights.
  if (!vertex.is_smooth() || (hide_emitters && vertex.light())) return false;
  const auto seen = scene.sensor().sample_direct(vertex.p(), lens, w.time);
  if (!seen || !(seen->importance > 0)) return false;
  if (!vertex.is_surface() && !scene.may_see(*state.medium, seen->p)) return false;
  BasicResponse<L> response;
  Spectrum own, other;
  if (!vertex.respond(seen->wo, response) || !pdfs(*seen, response, own, other)) return false;
  out.set(vertex.origin(), seen->wo, RayOrigin::in_space(seen->p));
  out.through_emitters = hide_emitters;
  out.near = response.value.scaled(seen->importance);
  out.far = beta;
  if (scene.has_media()) out.begin_in(vertex.leaving(seen->wo, state), key);
  out.weigh(scene.has_media(), own, other, w);
  film = seen->film;
  return true;
}

}  // namespace aureole
