// SPDX-License-Identifier: Apache-2.0
// Properties of a scene's media: which medium surrounds a point, which media are lights, which media light
// sampling cannot reach, and which are not enclosed (in a body with a gap, or around the sensor).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/random.h"
#include "aureole/math/warp.h"
#include "aureole/scene/boxes.h"
#include "aureole/scene/contact_search.h"
#include "aureole/scene/emitting_media.h"
#include "aureole/scene/scene.h"

namespace aureole {

void Scene::shapes_around(const Ray& ray, InteriorList& inside) const {
  if (!is_in(ray.o, ranked_bounds_)) return;
  // A body contains the origin of a ray that leaves the body before entering it. `First` is the first hit of
  // each body. Entering the bodies in reverse order of these exits orders equal ranks as a ray that comes
  // from outside would. All hits at once, since a march would skip surfaces that touch.
  struct First {
    InteriorList::Body body;
    float end;  // distance beyond which hits of the body do not count
    bool is_left;
  };
  std::vector<First> bodies;
  thread_local std::vector<RayTracer::Hit> hits;
  tracer().all_hits({ray.o, ray.d, kInfinity}, 0, hits);
  for (const RayTracer::Hit& hit : hits) {
    if (surfaces_.of(hit).rank == 0) continue;
    const SurfacePoint point = surface_point(hit, ray);
    const InteriorList::Body body{point.surface, point.instance};
    const bool is_left = dot(ray.d, point.ng) > 0;
    const auto known =
        std::find_if(bodies.begin(), bodies.end(), [&](const First& f) { return f.body == body; });
    if (known == bodies.end())
      bodies.push_back({body, hit.t + 2 * contact_distance(point, ray.d), is_left});
    else if (hit.t <= known->end)
      known->is_left |= is_left;
  }
  for (auto first = bodies.rbegin(); first != bodies.rend(); ++first)
    if (first->is_left) inside.pass(first->body, true);
}

const Medium* Scene::medium_at(const Ray& ray, const InteriorList& inside) const {
  const InteriorList::Body filling = inside.filling();
  const bool decides = filling.decides_medium();
  const Medium* const filled = decides ? filling.surface->inside : nullptr;
  if (media_bounds_.empty() || (!any_medium_outside_ && !is_in(ray.o, media_bounds_))) return filled;
  // If the ray hits no surface that determines the medium, a ray towards the centre of the media's bounds is
  // tried.
  const Vec3 inwards = media_bounds_.center() - ray.o;
  for (const Vec3& d : {ray.d, normalize(inwards)}) {
    // bodies with a rank that the ray has entered: surfaces within them do not determine the medium around the
    // origin
    InteriorList entered;
    const auto judge = [&](const SurfacePoint& point) -> std::optional<const Medium*> {
      const Surface& s = *point.surface;
      const InteriorList::Body body{&s, point.instance};
      if (entered.empty() && decides && inside.contains(body)) return filled;
      const bool tells = s.rank == 0 || (s.rank < 0 && inside.empty());
      if (entered.empty() && s.bounds_media && tells) return s.medium_along(-d, point.ng, nullptr);
      if (s.rank != 0) entered.pass(body, dot(d, point.ng) < 0);
      return {};
    };
    Ray next{ray.o, d, kInfinity};
    while (const auto point = intersect(next)) {
      if (!point->surface->touches) {
        if (const auto found = judge(*point)) return *found;
      } else {
        // Surfaces that the offset of the next origin would skip.
        thread_local std::vector<RayTracer::Hit> near;
        tracer().all_hits({next.o, d, length(point->p - next.o) + 2 * contact_distance(*point, d)}, 0, near);
        for (const RayTracer::Hit& hit : near)
          if (const auto found = judge(surface_point(hit, next))) return *found;
      }
      next.o = offset_origin(*point, d);
    }
  }
  return filled;
}

/// Whether the front of a closed surface faces outwards; normals may point inwards, as around a bubble in a
/// medium. Tests rays from outside; returns false if none of them hits the surface.
bool Scene::faces_outwards(std::size_t part) const {
  const Bounds3 box = parts_.surfaces[part].bounds();
  bool is_met = false;
  for (const Vec3& axis : {Vec3{1, 0.01f, 0.02f}, {0.02f, 1, 0.01f}, {0.01f, 0.02f, 1}, {1, 1.1f, 0.9f}}) {
    const Vec3 d = normalize(axis);
    Ray ray{box.center() - d * length(box.diagonal()), d, kInfinity};
    while (const auto point = intersect(ray)) {
      if (point->surface == &surfaces_.all[part]) {
        if (!(dot(d, point->ng) < 0)) return false;
        is_met = true;
        break;
      }
      ray.o = offset_origin(*point, d);
    }
  }
  return is_met;
}

void Scene::find_closed_media() {
  // Whether a surface may transmit light straight. A shape of higher priority makes the surface of a medium
  // inactive, and must then enclose the medium itself.
  const auto lets_pass = [](const Surface& s) { return s.passable || s.light; };
  const bool priorities_close = std::none_of(surfaces_.all.begin(), surfaces_.all.end(),
                                             [&](const Surface& s) { return s.rank != 0 && lets_pass(s); });
  std::vector<const Medium*> open;
  const auto is_open = [&](const Medium* medium) {
    return std::find(open.begin(), open.end(), medium) != open.end();
  };
  // Media that objects state need not be enclosed by a surface.
  open.push_back(parts_.sensor->medium());
  for (const Light& light : emitters_) open.push_back(light.emitter->medium());
  for (std::size_t i = 0; i < surfaces_.all.size(); ++i) {
    const Surface& s = surfaces_.all[i];
    if (s.outside) open.push_back(s.outside);
    const bool closes = i < parts_.surfaces.size() && parts_.surfaces[i].encloses_medium && !lets_pass(s) &&
                        (s.rank == 0 || priorities_close);
    if (s.inside && !(closes && faces_outwards(i))) open.push_back(s.inside);
  }
  for (std::size_t i = 0; i < parts_.surfaces.size(); ++i) {
    const Medium* medium = surfaces_.all[i].inside;
    if (!medium || is_open(medium)) continue;
    auto known =
        std::find_if(closed_.begin(), closed_.end(), [&](const Closed& c) { return c.medium == medium; });
    if (known == closed_.end()) known = closed_.insert(closed_.end(), {medium, {}, false, false});
    known->box.extend(widened(parts_.surfaces[i].bounds()));
    known->is_ranked |= surfaces_.all[i].rank != 0;
  }
  // Segments from a body with a rank may lead into other bodies that it touches.
  Bounds3 ranked;
  for (const Closed& c : closed_)
    if (c.is_ranked) ranked.extend(c.box);
  for (Closed& c : closed_)
    if (c.is_ranked) c.box = ranked;
  for (Closed& c : closed_)
    for (const Light& light : emitters_) {
      if (light.is_infinite()) continue;
      for (std::size_t part = 0; part < light.part_count() && !c.lights_inside; ++part)
        c.lights_inside = overlap(c.box, widened(light.emission_bounds(part).box));
    }
}

bool Scene::Closed::may_contain(const Vec3& p) const { return is_in(p, box); }

void Scene::find_emitting_media(const SampledSpectrum& response, std::vector<SampledSpectrum>& powers) {
  if (!any_medium_emits_) return;
  // The volumes of the emissive media from the surfaces around them: a box for each closed surface, or one
  // box around all surfaces of the medium if some are flat and enclose a volume only together.
  std::vector<std::pair<const Medium*, std::vector<Bounds3>>> found;
  const auto add = [&](const MediumPtr& medium, const Bounds3& box) {
    if (!medium || !medium->emits()) return;
    auto at =
        std::find_if(found.begin(), found.end(), [&](const auto& f) { return f.first == medium.get(); });
    if (at == found.end()) at = found.insert(found.end(), {medium.get(), {}});
    at->second.push_back(box);
  };
  for (const Primitive& part : parts_.surfaces) {
    if (!part.instance) {
      add(part.media.inside, part.bounds());
      continue;
    }
    for (const SurfaceMedia& media : part.member_media()) add(media.inside, part.bounds());
  }
  std::vector<EmittingMedia::Filled> filled;
  for (auto& [medium, boxes] : found) {
    const auto is_flat = [](const Bounds3& b) {
      const Vec3 d = b.diagonal();
      return !(d.x > 0 && d.y > 0 && d.z > 0);
    };
    if (medium->majorants() || std::any_of(boxes.begin(), boxes.end(), is_flat)) {
      for (const Bounds3& b : boxes) boxes[0].extend(b);
      boxes.resize(1);
    }
    for (const Bounds3& b : boxes) filled.push_back({medium, b});
  }
  auto media = std::make_shared<EmittingMedia>(filled, response);
  if (media->empty()) return;
  powers.insert(powers.end(), media->powers().begin(), media->powers().end());
  emitting_media_ = std::move(media);
}

namespace {

/// Counts the hits of rays that start at an open surface into the medium behind it.
struct OpenBody {
  int rays = 0;
  int itself = 0;  ///< number of rays that hit that body from inside
  int leaks = 0;   ///< number of rays that hit nothing
  Vec3 leak;

  /// Distinguishes a bowl without a lid from a plane or a sea surface above an unbounded medium, whose rays
  /// hardly ever hit the surface again.
  bool is_body_with_gap() const { return 4 * itself >= rays && leaks >= 4 && 64 * leaks >= rays; }
};

OpenBody look_into(const Scene& scene, std::size_t index) {
  constexpr int kRays = 256;
  const std::vector<Primitive>& parts = scene.parts().surfaces;
  const Bounds3 box = parts[index].bounds();
  std::vector<const Shape*> body;
  for (const Primitive& part : parts)
    if (part.shape && part.element == parts[index].element) body.push_back(part.shape.get());
  OpenBody found;
  for (std::uint32_t k = 0; k < kRays; ++k) {
    std::uint32_t dimension = 0;
    const auto next = [&] { return unit_float(std::uint32_t(combine_bits(k, dimension++))); };
    // A point on the surface is sampled by a ray from a random direction.
    const float x = next(), y = next(), z = next();
    const Vec3 towards = box.lower + box.diagonal() * Vec3{x, y, z};
    const float u = next(), v = next();
    const Vec3 d = square_to_uniform_sphere({u, v});
    Ray ray{towards - d * (length(box.diagonal()) * 1.01f), d, kInfinity};
    auto point = scene.intersect(ray);
    while (point && point->surface->shape != parts[index].shape.get()) {
      ray.o = offset_origin(*point, d);
      point = scene.intersect(ray);
    }
    if (!point) continue;
    ++found.rays;
    const float a = next(), b = next();
    ray.d = Frame::from_normal(-point->ng).to_world(square_to_cosine_hemisphere({a, b}));
    for (;;) {
      ray.o = offset_origin(*point, ray.d);
      point = scene.intersect(ray);
      if (!point) {
        ++found.leaks, found.leak = ray.d;
        break;
      }
      if (std::find(body.begin(), body.end(), point->surface->shape) != body.end()) {
        ++found.itself;
        break;
      }
      if (!point->surface->passable || point->surface->bounds_media) break;
    }
  }
  return found;
}

/// Throws Error for a medium inside a body with a gap through which rays leave the scene: the medium would
/// continue outside without bound.
void check_open_bodies(const Scene& scene) {
  const std::vector<Primitive>& parts = scene.parts().surfaces;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const SurfaceMedia& media = parts[i].media;
    if (!parts[i].shape || !media.inside || media.inside == media.outside || parts[i].encloses_medium)
      continue;
    const OpenBody found = look_into(scene, i);
    if (found.is_body_with_gap())
      throw parts[i].element->error(
          "interior",
          fmt::format("the body that this medium fills has a gap: from within one sees out of the scene, for "
                      "instance along ({:.2g}, {:.2g}, {:.2g}). Close it, or put a surface before the gap",
                      found.leak.x, found.leak.y, found.leak.z));
  }
}

/// Throws Error if an object states that it lies in a medium that only instances have: it could lie in any of
/// them.
void check_stated_medium(const Scene& scene, const Medium* medium, const Properties& object) {
  if (!medium) return;
  for (const Surface& s : scene.surfaces().all)
    if (s.inside == medium || s.outside == medium) return;
  for (const Primitive& part : scene.parts().surfaces) {
    if (part.placed_media.empty()) continue;
    for (const SurfaceMedia& media : part.instance->list().media)
      if (media.inside.get() == medium)
        throw Error(object.where(),
                    fmt::format("\"{}\" states that it lies in a medium that is not the same everywhere and "
                                "that only instances place in the scene. Leave the medium out: the surfaces "
                                "around tell which it is",
                                object.type()));
  }
}

}  // namespace

void Scene::check_sensor_medium() const {
  check_open_bodies(*this);
  check_stated_medium(*this, sensor_.sensor->medium(), sensor_.properties());
  for (const Light& light : emitters_)
    check_stated_medium(*this, light.emitter->medium(), light.properties());
  if (sensor_.sensor->medium() || media_bounds_.empty()) return;
  const Ray view =
      sensor_
          .sample_ray({sensor_.part.left + 0.5f * sensor_.part.width, 0.5f * sensor_.part.height},
                      {0.5f, 0.5f})
          .ray;
  // Directions on a spiral over the sphere avoid the edges of axis-aligned boxes.
  constexpr int kDirections = 16, kLeaks = 2;
  const Surface* within = nullptr;
  int leaks = 0;
  Vec3 leak;
  for (int i = 0; i < kDirections; ++i) {
    const float z = 1 - (2 * float(i) + 1) / kDirections, r = std::sqrt(1 - z * z),
                turn = 2.3999632f * float(i);
    Ray next{view.o, {r * std::cos(turn), r * std::sin(turn), z}, kInfinity};
    for (;;) {
      const auto point = intersect(next);
      if (!point) {
        ++leaks, leak = next.d;
        break;
      }
      const Surface& surface = *point->surface;
      if (surface.bounds_media && surface.rank <= 0) {
        if (surface.inside && dot(next.d, point->ng) > 0) within = &surface;
        break;
      }
      if (!surface.passable) break;
      next.o = offset_origin(*point, next.d);
    }
  }
  // Several rays must leave, since a single ray may leak between two adjacent triangles.
  if (within && leaks >= kLeaks)
    throw Error(sensor_.properties().where(),
                fmt::format("the sensor is in the medium within \"{}\", which is not closed: from there one "
                            "sees out along ({:.2g}, {:.2g}, {:.2g}) without meeting a surface. Close it, or "
                            "say by a <ref> to a medium in the sensor which one it is in",
                            within->shape->properties().type(), leak.x, leak.y, leak.z));
}

}  // namespace aureole
