// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/ray_tracer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"

namespace aureole {

namespace {

// Smallest distance of a hit. It is not zero: a point on a plane through zero has no rounding error and so no
// offset, and its distance to the plane is exactly 0.
constexpr float kMinDistance = std::numeric_limits<float>::min();

/// The context of a query for all hits. Embree hands it to `keep_hit`.
struct AllHitsContext {
  RTCIntersectContext context;  // first member, so that its address is the address of the whole object
  std::vector<RayTracer::Hit>* hits;
};

/// Returns a hit by Embree's numbers; `instance` is the number of the geometry's group, or invalid.
RayTracer::Hit hit_of(unsigned geometry, unsigned instance, unsigned primitive, float u, float v, float t) {
  const bool instanced = instance != RTC_INVALID_GEOMETRY_ID;
  return {{instanced ? geometry : 0, primitive, u, v, t}, instanced ? instance : geometry};
}

/// Stores a hit and rejects it, so that Embree continues with the other hits.
void keep_hit(const RTCFilterFunctionNArguments* args) {
  if (args->valid[0] != -1) return;
  const auto& all = *reinterpret_cast<const AllHitsContext*>(args->context);
  const unsigned n = args->N;
  all.hits->push_back(hit_of(RTCHitN_geomID(args->hit, n, 0), RTCHitN_instID(args->hit, n, 0, 0),
                             RTCHitN_primID(args->hit, n, 0), RTCHitN_u(args->hit, n, 0),
                             RTCHitN_v(args->hit, n, 0), RTCRayN_tfar(args->ray, n, 0)));
  args->valid[0] = 0;
}

RTCIntersectContext context_for(RayTracer::Rays kind) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = kind == RayTracer::Rays::coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

}  // namespace

void RayTracer::load_ray(const Ray& ray, RTCRay& r) const {
  r.org_x = ray.o.x, r.org_y = ray.o.y, r.org_z = ray.o.z;
  r.dir_x = ray.d.x, r.dir_y = ray.d.y, r.dir_z = ray.d.z;
  r.tnear = kMinDistance, r.tfar = ray.t_max, r.time = window_.fraction(ray.time);
  r.mask = ~0u, r.id = 0, r.flags = 0;
}

/// Loads a packet of 8 or 16 lanes. Lanes beyond n and untraceable rays are not `valid`.
template <class Rtc>
void RayTracer::load(const RayPacket& rays, int n, Rtc& r, int* valid) const {
  constexpr int kLanes = sizeof r.org_x / sizeof(float), kVector = 8;
  using Floats = float __attribute__((vector_size(4 * kVector)));
  using Ints = int __attribute__((vector_size(4 * kVector)));
  float* const to[] = {r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y, r.dir_z, r.tfar};
  const float* const from[] = {rays.o_[0], rays.o_[1], rays.o_[2], rays.d_[0],
                               rays.d_[1], rays.d_[2], rays.t_max_};
  for (int lane = 0; lane < kLanes; lane += kVector) {
    Ints good = Ints{0, 1, 2, 3, 4, 5, 6, 7} < n - lane;
    for (int k = 0; k < 7; ++k) {
      Floats x;
      std::memcpy(&x, from[k] + lane, sizeof x);
      std::memcpy(to[k] + lane, &x, sizeof x);
      const float limit = k < 6 ? farthest_ : std::numeric_limits<float>::infinity();
      good &= (x <= limit) & (x >= -limit);
    }
    std::memcpy(valid + lane, &good, sizeof good);
  }
  std::fill_n(r.tnear, kLanes, kMinDistance);
  if (window_.is_open)
    for (int lane = 0; lane < kLanes; ++lane) r.time[lane] = window_.fraction(rays.time_[lane]);
  else
    std::fill_n(r.time, kLanes, 0.f);
  std::fill_n(r.mask, kLanes, ~0u);
  std::fill_n(r.id, kLanes, 0u);
  std::fill_n(r.flags, kLanes, 0u);
}

template <class Rtc, class Query>
void RayTracer::intersect_lanes(const RayPacket& rays, int n, Hit* hits, Query&& query) const {
  alignas(64) Rtc p;
  alignas(64) int valid[RayPacket::kSize];
  load(rays, n, p.ray, valid);
  constexpr int kLanes = sizeof p.hit.geomID / sizeof p.hit.geomID[0];
  std::fill_n(p.hit.geomID, kLanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(p.hit.instID[0], kLanes, RTC_INVALID_GEOMETRY_ID);
  query(valid, p);
  for (int i = 0; i < n; ++i) {
    const bool instanced = p.hit.instID[0][i] != RTC_INVALID_GEOMETRY_ID;
    Hit& h = hits[i];
    h.geometry = instanced ? p.hit.geomID[i] : valid[i] ? 0 : Hit::kLost;
    h.primitive = p.hit.primID[i];
    h.u = p.hit.u[i], h.v = p.hit.v[i], h.t = p.ray.tfar[i];
    static_assert(RTC_INVALID_GEOMETRY_ID == ~0u);
    h.shape = instanced ? p.hit.instID[0][i] : p.hit.geomID[i];
  }
}

template <class Rtc, class Query>
void RayTracer::occluded_lanes(const RayPacket& rays, int n, bool* blocked, Query&& query) const {
  alignas(64) Rtc p;
  alignas(64) int valid[RayPacket::kSize];
  load(rays, n, p, valid);
  query(valid, p);
  for (int i = 0; i < n; ++i) blocked[i] = p.tfar[i] < 0 || !valid[i];
}

RayTracer::RayTracer(std::span<const Primitive> parts, const RayTracer* reuse) {
  if (reuse) {
    device_ = reuse->device_;
  } else {
    limit_library_threads();
    // Without this setting Embree reserves 128 MiB for subdivision surfaces, which no shape uses.
    std::string settings = "tessellation_cache_size=0";
#ifdef AUREOLE_STD_THREADS
    // Embree uses one thread, since ThreadSanitizer cannot observe the synchronisation of its threads when
    // they build in TBB.
    settings += ",threads=1";
#endif
    device_ = {rtcNewDevice(settings.c_str()), rtcReleaseDevice};
    if (!device_) throw Error("Embree cannot be started");
  }
  owned_scene_ = new_scene();
  scene_ = owned_scene_.get();
  std::unordered_map<const ShapeList*, const Group*> group_of_list;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Primitive& part = parts[i];
    items_.push_back({part.shape, part.instance});
    if (part.instance) {
      const Group*& group = group_of_list[&part.instance->list()];
      if (!group) group = &group_of(part.instance->list(), reuse);
      RTCGeometry geometry = part.instance->make_geometry(device_.get(), group->handle.get());
      rtcAttachGeometryByID(scene_, geometry, unsigned(i));
      rtcReleaseGeometry(geometry);
      farthest_ = std::min(farthest_, part.instance->farthest(kFarthest));
      if (part.instance->is_moving()) window_ = part.instance->window();
    } else {
      rtcAttachGeometryByID(scene_, geometry_of(part.shape, reuse)->handle.get(), unsigned(i));
    }
    bounds_.extend(part.bounds());
  }
  rtcCommitScene(scene_);
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error != RTC_ERROR_NONE)
    throw Error(error == RTC_ERROR_OUT_OF_MEMORY ? "not enough memory for the acceleration structure"
                                                 : "Embree reports error " + std::to_string(int(error)));
}

std::shared_ptr<RTCSceneTy> RayTracer::new_scene() const {
  std::shared_ptr<RTCSceneTy> scene(rtcNewScene(device_.get()), rtcReleaseScene);
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  return scene;
}

std::shared_ptr<const RayTracer::Geometry> RayTracer::geometry_of(const ShapePtr& shape,
                                                                  const RayTracer* reuse) {
  std::shared_ptr<const Geometry>& known = geometries_[shape.get()];
  if (known) return known;
  if (reuse)
    if (const auto kept = reuse->geometries_.find(shape.get()); kept != reuse->geometries_.end())
      return known = kept->second;
  known = std::make_shared<const Geometry>(
      Geometry{shape, {shape->make_geometry(device_.get()), rtcReleaseGeometry}});
  return known;
}

const RayTracer::Group& RayTracer::group_of(const ShapeList& list, const RayTracer* reuse) {
  const auto has_these = [&](const std::shared_ptr<const Group>& group) {
    return std::equal(group->members.begin(), group->members.end(), list.shapes.begin(), list.shapes.end(),
                      [](const auto& member, const ShapePtr& shape) { return member->shape == shape; });
  };
  if (const auto own = std::find_if(groups_.begin(), groups_.end(), has_these); own != groups_.end())
    return **own;
  if (reuse)
    if (const auto kept = std::find_if(reuse->groups_.begin(), reuse->groups_.end(), has_these);
        kept != reuse->groups_.end()) {
      for (const auto& member : (*kept)->members) geometries_.emplace(member->shape.get(), member);
      return *groups_.emplace_back(*kept);
    }
  auto made = std::make_shared<Group>();
  made->handle = new_scene();
  for (std::size_t i = 0; i < list.shapes.size(); ++i) {
    made->members.push_back(geometry_of(list.shapes[i], reuse));
    rtcAttachGeometryByID(made->handle.get(), made->members.back()->handle.get(), unsigned(i));
  }
  rtcCommitScene(made->handle.get());
  return *groups_.emplace_back(std::move(made));
}

bool RayTracer::is_for(std::span<const Primitive> parts) const {
  // The last compared lists of shapes. Instances of one group are consecutive, so that its list is compared
  // only once.
  const ShapeList *a = nullptr, *b = nullptr;
  const auto same_shapes = [&](const ShapeList& x, const ShapeList& y) {
    if (&x == &y || (a == &x && b == &y)) return true;
    if (x.shapes != y.shapes) return false;
    a = &x, b = &y;
    return true;
  };
  return std::equal(items_.begin(), items_.end(), parts.begin(), parts.end(),
                    [&](const Item& item, const Primitive& part) {
                      if (item.instance && part.instance)
                        return item.instance->is_in_same_place(*part.instance) &&
                               same_shapes(item.instance->list(), part.instance->list());
                      return item.shape == part.shape && !item.instance && !part.instance;
                    });
}

RayTracer::Hit RayTracer::intersect(const Ray& ray) const {
  if (!is_traceable(ray)) return {{Hit::kLost}, ~0u};
  RTCRayHit r;
  load_ray(ray, r.ray);
  r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return hit_of(r.hit.geomID, r.hit.instID[0], r.hit.primID, r.hit.u, r.hit.v, r.ray.tfar);
}

void RayTracer::all_hits(const Ray& ray, float t_min, std::vector<Hit>& hits) const {
  hits.clear();
  if (!is_traceable(ray)) return;
  RTCRayHit r;
  load_ray(ray, r.ray);
  r.ray.tnear = std::max(t_min, kMinDistance);
  r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  AllHitsContext all;
  rtcInitIntersectContext(&all.context);
  all.context.filter = keep_hit;
  all.hits = &hits;
  rtcIntersect1(scene_, &all.context, &r);
  std::stable_sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
}

bool RayTracer::occluded(const Ray& ray) const {
  if (!is_traceable(ray)) return true;
  RTCRay r;
  load_ray(ray, r);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &r);
  return r.tfar < 0;
}

void RayTracer::intersect(const RayPacket& rays, int n, Rays kind, Hit* hits) const {
  if (n < 2) {
    if (n == 1) hits[0] = intersect(rays.get(0));
    return;
  }
  RTCIntersectContext context = context_for(kind);
  if (n > 8)
    intersect_lanes<RTCRayHit16>(
        rays, n, hits, [&](int* valid, RTCRayHit16& p) { rtcIntersect16(valid, scene_, &context, &p); });
  else
    intersect_lanes<RTCRayHit8>(
        rays, n, hits, [&](int* valid, RTCRayHit8& p) { rtcIntersect8(valid, scene_, &context, &p); });
}

void RayTracer::occluded(const RayPacket& rays, int n, bool* blocked) const {
  if (n < 2) {
    if (n == 1) blocked[0] = occluded(rays.get(0));
    return;
  }
  // Packets are never marked coherent. Compiled by GCC before version 14, Embree's occludedCoherent may read
  // its 16-bit ray mask together with 48 uninitialised bits of the stack, and then loops forever. (Debian's
  // 3.13.5 does so for 16 rays and instances or compact triangles; Embree's pull request 574 fixes it.)
  RTCIntersectContext context = context_for(Rays::incoherent);
  if (n > 8)
    occluded_lanes<RTCRay16>(rays, n, blocked,
                             [&](int* valid, RTCRay16& p) { rtcOccluded16(valid, scene_, &context, &p); });
  else
    occluded_lanes<RTCRay8>(rays, n, blocked,
                            [&](int* valid, RTCRay8& p) { rtcOccluded8(valid, scene_, &context, &p); });
}

}  // namespace aureole
