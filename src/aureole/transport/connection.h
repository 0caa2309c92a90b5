// SPDX-License-Identifier: Apache-2.0
// Connections: straight segments from a point of a path to another one, or into a direction, with their
// visibility. This file has the only visibility tests, and the only march through passable surfaces.
#pragma once

#include "aureole/scene/scene.h"
#include "aureole/transport/anchor.h"

namespace aureole {

/// The result of following a ray.
enum class Event : std::uint8_t {
  surface,  ///< it ends at a vertex
  escape,   ///< it leaves the scene or reaches its target
  crossed,  ///< it has passed a null surface or a medium's boundary and must be traced again
  blocked,  ///< it is occluded or absorbed
};

struct Connection {
  Ray ray;      ///< the part that is still to be tested; ends at t = 1 unless it is infinite
  Vec3 d;       ///< unit direction
  Vec3 target;  ///< the far end, if there is one
  bool infinite;
  bool through_emitters;  ///< surfaces of emitters do not occlude it
  Spectrum light;         ///< the contribution if it is unoccluded, times the transmittance so far

  /// From a point along `direction` to another, off the surfaces that they lie on.
  void set(const Anchor& from, const Vec3& direction, const Anchor& to);
  /// Along a ray.
  void set(const Ray& ray);
};

/// A connection has met a surface: crossed, blocked, or escape where its end lies on that surface, too.
Event cross(const SurfacePoint& point, Connection& connection, const Wavelengths& w);

/// Tests one connection; returns whether its light arrives. Those of a batch: `connect_all` of the driver.
bool connect(const Scene& scene, Connection& connection, const Wavelengths& w);

inline void Connection::set(const Anchor& from, const Vec3& direction, const Anchor& to) {
  ray.o = offset_origin(from.p, from.p_error, from.ng, direction);
  // The far end leaves its surface, too, so that the segment needs no shortening by a constant. The rounding
  // of the ray's own arithmetic counts: direction, distance and differences of the length of the segment,
  // gamma(10) of each.
  const Vec3 error = to.p_error + (abs(ray.o) + abs(to.p) + abs(to.p - ray.o)) * gamma_bound(10);
  target = offset_origin(to.p, error, to.ng, -direction);
  ray.d = target - ray.o, ray.t_max = 1;
  d = direction;
  infinite = through_emitters = false;
}

inline void Connection::set(const Ray& r) {
  ray = r;
  d = r.d;
  infinite = true, through_emitters = false;
}

}  // namespace aureole
