// SPDX-License-Identifier: Apache-2.0
// Connections: straight segments from a point of a path to another one, or into a direction, with their
// visibility. This file has the only visibility tests, and the only march through passable surfaces.
#pragma once

#include <limits>

#include "aureole/scene/scene.h"
#include "aureole/transport/anchor.h"
#include "aureole/transport/flight.h"

namespace aureole {

/// The result of following a ray.
enum class Event : std::uint8_t {
  surface,  ///< it ends at a vertex on a surface
  medium,   ///< it ends at a vertex within a medium
  entered,  ///< it goes on below a surface with a BSSRDF (transport/emerge.h)
  escape,   ///< it leaves the scene or reaches its target
  crossed,  ///< it has passed a null surface or a medium's boundary and must be traced again
  blocked,  ///< it is occluded or absorbed
};

struct Connection {
  Flight flight;  ///< the part that is still to be tested; ends at t = 1 unless it is infinite
  Vec3 origin;    ///< where it begins
  Vec3 d;         ///< unit direction
  Vec3 target;    ///< the far end, if there is one
  bool infinite;
  bool through_emitters;  ///< surfaces of emitters do not occlude it
  /// The contribution if it is unoccluded, times the part that has passed so far. With media the estimate of a
  /// path of density 1, which `finish` divides.
  Spectrum light;

  // In scenes with media, of which `travel` takes account (transport/flight.h):
  std::uint32_t key;  ///< for random numbers
  /// Densities, relative to that of the path's hero, of this connection and of finding it by other techniques,
  /// the second as if the medium were clear.
  Spectrum own, other;
  Spectrum passed;         ///< part of the light that has passed media
  Spectrum passed_before;  ///< the same without the medium that it is in
  const Medium* source;    ///< the medium whose emission it brings, which must be at its end; null: a surface
  bool others_pass;        ///< other techniques go through media with certainty, as if these were clear

  /// From a point along `direction` to another, off the surfaces that they lie on.
  void set(const Anchor& from, const Vec3& direction, const Anchor& to);
  /// Along a ray.
  void set(const Ray& ray);
  /// Where it begins, in scenes with media.
  void begin_in(const Flight& surroundings, std::uint32_t random_key) {
    flight.medium = surroundings.medium, flight.inside = surroundings.inside;
    key = random_key, passed = passed_before = 1.f;
    source = nullptr;
    others_pass = false;
  }
  /// The light arrives: `light` becomes the contribution.
  void finish() {
    if (source && flight.medium != source) {
      light = 0.f;
      return;
    }
    // A walk finds the emission of a uniform medium wherever it is scattered there.
    const Spectrum& walked = source && !source->majorants() ? passed_before : passed;
    light *= passed * (1 / sum(own + (others_pass ? other : other * walked)));
  }
  /// It cannot be traced: the sample is invalid, which is counted.
  void lose() { light = std::numeric_limits<float>::quiet_NaN(); }
};

/// A connection has gone on to the distance `t` along its ray: attenuates it by the medium that it is in. `glow` as of
/// `transmittance`.
void travel(Connection& connection, float t, const Wavelengths& w, Glow* glow = nullptr);

/// A connection has met a surface: crossed, blocked, or escape where its end lies on that surface, too.
Event cross(const SurfacePoint& point, Connection& connection, const Wavelengths& w);

/// The same of what the ray tracer has found, with the media before it.
inline Event cross(const Scene& scene, const RayTracer::Hit& hit, Connection& c, const Wavelengths& w) {
  if (hit.is_lost()) return c.lose(), Event::escape;
  if (scene.has_media() && c.flight.medium) travel(c, hit ? hit.t : c.flight.ray.t_max, w);
  return hit ? cross(scene.surface_point(hit, c.flight.ray), c, w) : Event::escape;
}

/// Whether a connection that is not open could not be traced; then it counts as open, with invalid light.
bool is_lost(const Scene& scene, Connection& connection);

/// Tests one connection; returns whether its light arrives. Those of a batch: `connect_all` of the driver.
bool connect(const Scene& scene, Connection& connection, const Wavelengths& w);

inline void Connection::set(const Anchor& from, const Vec3& direction, const Anchor& to) {
  origin = from.p;
  flight.ray.o = offset_origin(from.p, from.p_error, from.ng, direction);
  // The far end leaves its surface, too, so that the segment needs no shortening by a constant. The rounding
  // of the ray's own arithmetic counts: direction, distance and differences of the length of the segment,
  // gamma(10) of each.
  const Vec3 error =
      to.p_error + (abs(flight.ray.o) + abs(to.p) + abs(to.p - flight.ray.o)) * gamma_bound(10);
  target = offset_origin(to.p, error, to.ng, -direction);
  flight.ray.d = target - flight.ray.o, flight.ray.t_max = 1;
  d = direction;
  infinite = through_emitters = false;
}

inline void Connection::set(const Ray& r) {
  flight.ray = r;
  origin = r.o, d = r.d;
  infinite = true, through_emitters = false;
}

}  // namespace aureole
