// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/ray_tracer.h"

#include <limits>
#include <string>

#include "aureole/core/error.h"

namespace aureole {

namespace {

// Not zero: a point on a plane through zero has no rounding error and so no offset, and its distance to the
// plane is exactly 0.
constexpr float kNearest = std::numeric_limits<float>::min();

void load(const Ray& ray, RTCRay& r) {
  r.org_x = ray.o.x, r.org_y = ray.o.y, r.org_z = ray.o.z;
  r.dir_x = ray.d.x, r.dir_y = ray.d.y, r.dir_z = ray.d.z;
  r.tnear = kNearest, r.tfar = ray.t_max, r.time = 0;
  r.mask = ~0u, r.id = 0, r.flags = 0;
}

RTCIntersectContext context_for(RayTracer::Rays kind) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = kind == RayTracer::Rays::coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// Packets of 8 and of 16 lanes; `rays` has one or more and at most that many. Untraceable ones are not
/// `valid`.
template <class Packet>
void load(const Ray* rays, int n, Packet& r, int* valid) {
  constexpr int kLanes = sizeof r.org_x / sizeof r.org_x[0];
  for (int i = 0; i < kLanes; ++i) {
    const Ray& ray = rays[i < n ? i : 0];
    valid[i] = i < n && is_traceable(ray) ? -1 : 0;
    r.org_x[i] = ray.o.x, r.org_y[i] = ray.o.y, r.org_z[i] = ray.o.z;
    r.dir_x[i] = ray.d.x, r.dir_y[i] = ray.d.y, r.dir_z[i] = ray.d.z;
    r.tnear[i] = kNearest, r.tfar[i] = ray.t_max, r.time[i] = 0;
    r.mask[i] = ~0u, r.id[i] = 0, r.flags[i] = 0;
  }
}

template <class Packet, class Query>
void intersect_packet(const Ray* rays, int n, RayTracer::Hit* hits, Query&& query) {
  alignas(64) Packet p;
  alignas(64) int valid[16];
  load(rays, n, p.ray, valid);
  for (int i = 0; i < n; ++i) p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  query(valid, p);
  for (int i = 0; i < n; ++i) {
    hits[i] = {};
    if (p.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const bool instanced = p.hit.instID[0][i] != RTC_INVALID_GEOMETRY_ID;
    hits[i] = {{instanced ? p.hit.geomID[i] : 0, p.hit.primID[i], p.hit.u[i], p.hit.v[i], p.ray.tfar[i]},
               instanced ? p.hit.instID[0][i] : p.hit.geomID[i]};
  }
}

template <class Packet, class Query>
void occluded_packet(const Ray* rays, int n, bool* blocked, Query&& query) {
  alignas(64) Packet p;
  alignas(64) int valid[16];
  load(rays, n, p, valid);
  query(valid, p);
  for (int i = 0; i < n; ++i) blocked[i] = p.tfar[i] < 0 || !valid[i];
}
}  // namespace

RayTracer::RayTracer(std::span<const ShapePtr> shapes) {
#ifdef AUREOLE_STD_THREADS
  // ThreadSanitizer cannot see how Embree's own threads, which build in TBB, wait for one another.
  device_ = rtcNewDevice("threads=1");
#else
  device_ = rtcNewDevice(nullptr);
#endif
  if (!device_) throw Error("Embree cannot be started");
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  for (size_t i = 0; i < shapes.size(); ++i) {
    RTCGeometry geometry = shapes[i]->make_geometry(device_);
    rtcAttachGeometryByID(scene_, geometry, unsigned(i));
    rtcReleaseGeometry(geometry);
    bounds_.extend(shapes[i]->bounds());
  }
  rtcCommitScene(scene_);
  const RTCError error = rtcGetDeviceError(device_);
  if (error != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    throw Error(error == RTC_ERROR_OUT_OF_MEMORY ? "not enough memory for the acceleration structure"
                                                 : "Embree reports error " + std::to_string(int(error)));
  }
}

RayTracer::~RayTracer() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

RayTracer::Hit RayTracer::intersect(const Ray& ray) const {
  if (!is_traceable(ray)) return {};
  RTCRayHit r;
  load(ray, r.ray);
  r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const bool instanced = r.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  return {{instanced ? r.hit.geomID : 0, r.hit.primID, r.hit.u, r.hit.v, r.ray.tfar},
          instanced ? r.hit.instID[0] : r.hit.geomID};
}

bool RayTracer::occluded(const Ray& ray) const {
  if (!is_traceable(ray)) return true;
  RTCRay r;
  load(ray, r);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &r);
  return r.tfar < 0;
}

void RayTracer::intersect(const Ray* rays, int n, Rays kind, Hit* hits) const {
  RTCIntersectContext context = context_for(kind);
  if (n > 8)
    intersect_packet<RTCRayHit16>(
        rays, n, hits, [&](int* valid, RTCRayHit16& p) { rtcIntersect16(valid, scene_, &context, &p); });
  else if (n > 1)
    intersect_packet<RTCRayHit8>(
        rays, n, hits, [&](int* valid, RTCRayHit8& p) { rtcIntersect8(valid, scene_, &context, &p); });
  else if (n == 1)
    hits[0] = intersect(rays[0]);
}

void RayTracer::occluded(const Ray* rays, int n, bool* blocked) const {
  // Never as coherent ones: compiled by GCC before 14, Embree's occludedCoherent may read its 16-bit mask of
  // rays with 48 bits of what was on the stack, and then it loops for ever. (Debian's 3.13.5 does, for 16
  // rays and instances or compact triangles; Embree's pull request 574 has the cure.)
  RTCIntersectContext context = context_for(Rays::incoherent);
  if (n > 8)
    occluded_packet<RTCRay16>(rays, n, blocked,
                              [&](int* valid, RTCRay16& p) { rtcOccluded16(valid, scene_, &context, &p); });
  else if (n > 1)
    occluded_packet<RTCRay8>(rays, n, blocked,
                             [&](int* valid, RTCRay8& p) { rtcOccluded8(valid, scene_, &context, &p); });
  else if (n == 1)
    blocked[0] = occluded(rays[0]);
}

}  // namespace aureole
