// SPDX-License-Identifier: Apache-2.0
// Surfaces defined by equations as Embree user geometries: Embree finds the bounding boxes, the surface
// intersects the ray in double precision.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "aureole/shape/geometry/double3.h"

namespace aureole {

namespace detail {

/// Whether the surface type has several primitives; otherwise it is a single primitive.
template <class Surface>
constexpr bool kHasPrimitives = requires(const Surface& s) {
  s.primitive_count();
};

/// Returns the distance at which ray i of a packet of n rays hits the surface.
template <class Surface>
std::optional<float> packet_hit(const Surface& surface, unsigned primitive, RTCRayN* rays, unsigned n,
                                unsigned i) {
  const Double3 o(RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i));
  const Double3 d(RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i));
  const float near = RTCRayN_tnear(rays, n, i), far = RTCRayN_tfar(rays, n, i);
  std::optional<double> t;
  if constexpr (kHasPrimitives<Surface>)
    t = surface.intersect(primitive, o, d, near, far);
  else
    t = surface.intersect(o, d, near, far);
  return t ? std::optional<float>(std::min(float(*t), far)) : std::nullopt;
}

/// For a query of all hits (`RayTracer::all_hits`), which traces one ray: passes each hit to the query's
/// filter, which rejects it.
template <class Surface>
void show_all_hits(const Surface& surface, const RTCIntersectFunctionNArguments* args) {
  RTCRay* ray = reinterpret_cast<RTCRay*>(RTCRayHitN_RayN(args->rayhit, 1));
  const float near = ray->tnear, far = ray->tfar;
  while (const auto t = packet_hit(surface, args->primID, reinterpret_cast<RTCRayN*>(ray), 1, 0)) {
    RTCHit hit{};
    hit.Ng_z = 1;
    hit.primID = args->primID, hit.geomID = args->geomID, hit.instID[0] = args->context->instID[0];
    int valid = -1;
    RTCFilterFunctionNArguments shown{&valid,
                                      args->geometryUserPtr,
                                      args->context,
                                      reinterpret_cast<RTCRayN*>(ray),
                                      reinterpret_cast<RTCHitN*>(&hit),
                                      1};
    ray->tfar = *t;
    args->context->filter(&shown);
    ray->tfar = far;
    // The search continues beyond the next representable number, since the distance was rounded.
    ray->tnear = std::nextafter(*t, std::numeric_limits<float>::infinity());
  }
  ray->tnear = near;
}

template <class Surface>
void user_intersect(const RTCIntersectFunctionNArguments* args) {
  const Surface& surface = *static_cast<const Surface*>(args->geometryUserPtr);
  const unsigned n = args->N;
  if (args->context->filter && n == 1) {
    if (args->valid[0] == -1) show_all_hits(surface, args);
    return;
  }
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    const auto t = packet_hit(surface, args->primID, rays, n, i);
    if (!t) continue;
    RTCRayN_tfar(rays, n, i) = *t;
    // Normal and coordinates are not set, since surface_point computes everything else from the distance.
    RTCHitN_Ng_x(hits, n, i) = 0, RTCHitN_Ng_y(hits, n, i) = 0, RTCHitN_Ng_z(hits, n, i) = 1;
    RTCHitN_u(hits, n, i) = 0, RTCHitN_v(hits, n, i) = 0;
    RTCHitN_primID(hits, n, i) = args->primID;
    RTCHitN_geomID(hits, n, i) = args->geomID;
    RTCHitN_instID(hits, n, i, 0) = args->context->instID[0];
  }
}

template <class Surface>
void user_occluded(const RTCOccludedFunctionNArguments* args) {
  const Surface& surface = *static_cast<const Surface*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 && packet_hit(surface, args->primID, args->ray, args->N, i))
      RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
}

template <class Surface>
void user_bounds(const RTCBoundsFunctionArguments* args) {
  const Surface& surface = *static_cast<const Surface*>(args->geometryUserPtr);
  Bounds3 b;
  if constexpr (kHasPrimitives<Surface>)
    b = surface.bounds(args->primID);
  else
    b = surface.bounds();
  RTCBounds& r = *args->bounds_o;
  r.lower_x = b.lower.x, r.lower_y = b.lower.y, r.lower_z = b.lower.z;
  r.upper_x = b.upper.x, r.upper_y = b.upper.y, r.upper_z = b.upper.z;
}

}  // namespace detail

/// Returns a committed Embree geometry; `surface` must outlive it. A Surface has
///   Bounds3 bounds() const, and
///   std::optional<double> intersect(o, d, t_min, t_max) const: the nearest distance in (t_min, t_max).
/// A surface of several primitives also has primitive_count(), and both functions take the primitive first.
template <class Surface>
RTCGeometry make_user_geometry(RTCDevice device, const Surface& surface) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if constexpr (detail::kHasPrimitives<Surface>)
    rtcSetGeometryUserPrimitiveCount(g, unsigned(surface.primitive_count()));
  else
    rtcSetGeometryUserPrimitiveCount(g, 1);
  rtcSetGeometryUserData(g, const_cast<Surface*>(&surface));
  rtcSetGeometryBoundsFunction(g, detail::user_bounds<Surface>, nullptr);
  rtcSetGeometryIntersectFunction(g, detail::user_intersect<Surface>);
  rtcSetGeometryOccludedFunction(g, detail::user_occluded<Surface>);
  rtcCommitGeometry(g);
  return g;
}

}  // namespace aureole
