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

/// Follows a path along `ray`, whose direction has unit length, to the distance t_max. Returns true where it
/// is scattered before, at a distance `t`: the value of the passage then holds the scattering coefficient,
/// and its densities that of this place, `connection` that of a given one. False where it arrives at t_max.
///
/// `ratio` are the densities of the path so far (`PathDensity::ratio`). `emitted` receives, unless it is null, an
/// estimate of the light that the medium sends along the ray to its origin, weighted so that
/// `PathDensity::contribution` of it for the path before this flight is right; it must be zero before.
bool fly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w, FlightRandom random,
         const Spectrum& ratio, Passage& passage, Spectrum* emitted, float& t);

/// The same for a path of that density, from its vertex number `vertex`: `density` becomes that at the end of
/// the flight, `p` where it is scattered. The light that the medium emits is added to `estimate`, unless that is
/// null.
template <class Density>
bool fly(const Flight& flight, float t_max, const Wavelengths& w, SampleStream& samples, int vertex,
         Density& density, Spectrum* estimate, Vec3& p) {
  const FlightRandom random{get(samples, vertex, Choice::distance), key(samples, vertex, Key::flight)};
  Passage passage;
  Spectrum emitted = 0.f;
  float t;
  const bool scattered = fly(*flight.medium, flight.ray, t_max, w, random, density.ratio, passage,
                             estimate ? &emitted : nullptr, t);
  if (estimate && !is_black(emitted)) *estimate += density.contribution(emitted, w);
  density.pass(passage);
  if (scattered) p = flight.ray.o + flight.ray.d * t;
  return scattered;
}

/// An estimate of the part of the light that passes the medium along `ray`, from its origin to the distance
/// t_max. Unbiased for each wavelength; the same number is the ratio of the density of passing on a walk
/// to that of a connection.
Spectrum transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                       std::uint32_t key);

}  // namespace aureole
