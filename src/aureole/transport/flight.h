// SPDX-License-Identifier: Apache-2.0
// `Flight`: a ray with what it is in; and light in a medium between two surfaces: where a ray is scattered, and
// the part of a connection's light that arrives.
//
// Coefficients that vary are met by null collisions (Miller, Georgiev & Jarosz 2019, "A null-scattering path
// integral formulation of light transport"): the medium is filled up to a bound with matter that changes
// nothing, and the places of such events belong to the path. The bound is the largest over the wavelengths of
// a path, so that the density of places of events is the same for all of them and cancels.
#pragma once

#include "aureole/medium/medium.h"
#include "aureole/scene/emitting_media.h"
#include "aureole/scene/interior_list.h"
#include "aureole/scene/scene.h"
#include "aureole/spectrum/path_density.h"
#include "aureole/transport/dimensions.h"

namespace aureole {

/// A ray with what it is in. In scenes without media the ray is all that is kept up to date.
struct Flight {
  Ray ray;
  const Medium* medium = nullptr;  ///< at its origin, or null
  InteriorList inside;             ///< closed shapes with a priority that the origin lies in

  /// Whether a surface that the ray meets is not there, because another shape fills the space around it.
  bool is_hidden(const Surface& surface) const { return surface.priority != 0 && inside.hides(surface); }
  /// Takes the ray's direction `to` behind or before a surface that it has met along `from`.
  void pass(const SurfacePoint& point, const Vec3& from, const Vec3& to) {
    const Surface& surface = *point.surface;
    if (surface.priority == 0) {
      medium = surface.medium_along(to, point.ng, medium);
      return;
    }
    const bool inwards = dot(to, point.ng) < 0;
    if (inwards != (dot(from, point.ng) < 0)) return;  // reflected
    inside.pass(surface, inwards);
    const Surface* filling = inside.filling();
    medium = filling ? filling->inside : surface.outside;
  }
};

/// The medium and the closed shapes around the origin of a ray, which is that of the sensor or, given `light`,
/// leaves that one.
void find_surroundings(const Scene& scene, const Light* light, Flight& flight);
/// The same by the boundaries alone, where nothing states the medium.
void find_surroundings(const Scene& scene, Flight& flight);

/// A place where a path is scattered in a medium.
struct MediumPoint {
  Vec3 p;
  const Medium* medium = nullptr;
};

/// Random numbers of a flight: the first decides where the first event is, the key is for all others.
struct FlightRandom {
  float first;
  std::uint32_t key;
};

/// A vertex from which connections have looked for lights; `facing` as of `Vertex::facing`.
struct LightReference {
  Vec3 p, facing;
};

/// Where connections have looked for the emission that a flight meets.
struct EmissionSearch {
  const EmittingMedia* media = nullptr;  ///< among these; null: they have not
  LightReference from;                   ///< at this vertex
  /// The part of the path's `light_ratio` that counts: not that of connections which look for surfaces only.
  Spectrum share{1.f};
};

/// The light that a medium emits along a flight, towards its beginning.
struct Glow {
  /// Densities of the path before the flight: of walking, and as if the last vertex had been found by light
  /// sampling (`PathDensity`).
  Spectrum ratio{1.f}, light_ratio{0.f};
  /// The lights among which connections from the last vertex have looked for emission; null: they have not.
  const EmittingMedia* media = nullptr;
  LightReference from{};
  /// An estimate of the light over the sum of the densities of all ways to find it.
  Spectrum seen{0.f};
};

/// Follows a path along `ray`, whose direction has unit length, to the distance t_max. Returns true where it
/// is scattered before, at a distance `t`: the value of the passage then holds the scattering coefficient,
/// its density of flying that of this place, and that of connections that of a technique that goes to the
/// place without a choice. False where it arrives at t_max. Adds to `glow`, unless that is null.
bool fly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w, FlightRandom random,
         Passage& passage, Glow* glow, float& t);

/// The same for a path of that density, from its vertex number `vertex`: `density` becomes that at the end of
/// the flight, `p` where it is scattered. The light that the medium emits is added to `estimate`, unless that is
/// null, weighted against what `search` has found. Where it is scattered `chosen` receives, unless it is null, the
/// density of the path had its last place been chosen with density 1, relative to the hero's of flying there.
template <class Density>
bool fly(const Flight& flight, float t_max, const Wavelengths& w, SampleStream& samples, int vertex,
         Density& density, Spectrum* estimate, Vec3& p, const EmissionSearch& search = {},
         Spectrum* chosen = nullptr) {
  const FlightRandom random{get(samples, vertex, Choice::distance), key(samples, vertex, Key::flight)};
  Passage passage;
  float t;
  bool scattered;
  if (estimate && flight.medium->emits()) {
    Glow glow{density.ratio, density.light_ratio * search.share,
              density.has_light_ratio() ? search.media : nullptr, search.from};
    scattered = fly(*flight.medium, flight.ray, t_max, w, random, passage, &glow, t);
    if (!is_black(glow.seen)) *estimate += density.beta.of(glow.seen) / w.pdf;
  } else {
    scattered = fly(*flight.medium, flight.ray, t_max, w, random, passage, nullptr, t);
  }
  if (scattered) {
    if (chosen) *chosen = density.ratio * passage.connection;
    p = flight.ray.o + flight.ray.d * t;
  }
  density.pass(passage);
  return scattered;
}

/// Ends the flight's ray just behind the place where `fly` will scatter it, given the first of its random numbers, where
/// that is known before: the ray tracer then looks no farther. Not for flights along the whole of which something is
/// chosen or seen.
void end_at_event(Flight& flight, const Wavelengths& w, float first);

/// The formal density per length with which a flight finds emission at a place of a medium, as the weights of
/// all techniques take it, without that of passing what lies before. `size` is the inverse of the medium's.
float emission_rate(const Medium& medium, const Vec3& p, const Vec3& d, const Spectrum& sigma_t,
                    float inverse_size, const Wavelengths& w);

/// Light that goes straight through a medium.
struct Straight {
  /// The part that arrives: an estimate, unbiased for each wavelength, or exact. The same number is the ratio of
  /// the density of passing on a walk to that of passing without being scattered.
  Spectrum passed{1.f};
  float roulette = 1;  ///< factor of the estimate that is in no density; 0 where it was ended
};
/// Along `ray` from its origin to the distance t_max. Adds to `glow`, unless that is null, what the medium emits
/// along the way; its `ratio` is the density of arriving at t_max, too, since nothing is scattered.
Straight transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                       std::uint32_t key, Glow* glow = nullptr);
/// The same without roulette, so that a path may be scattered there.
Spectrum passed_to(const Medium& medium, const Ray& ray, float t, const Wavelengths& w, std::uint32_t key);

}  // namespace aureole
