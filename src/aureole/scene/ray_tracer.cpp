// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/ray_tracer.h"

#include <limits>
#include <string>

#include "aureole/core/error.h"

namespace aureole {

namespace {
void load(const Ray& ray, RTCRay& r) {
  r.org_x = ray.o.x, r.org_y = ray.o.y, r.org_z = ray.o.z;
  r.dir_x = ray.d.x, r.dir_y = ray.d.y, r.dir_z = ray.d.z;
  // Not zero: a point on a plane through zero has no rounding error and so no offset, and its distance to the
  // plane is exactly 0.
  r.tnear = std::numeric_limits<float>::min(), r.tfar = ray.t_max, r.time = 0;
  r.mask = ~0u, r.id = 0, r.flags = 0;
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

}  // namespace aureole
