// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/contact.h"

#include <algorithm>
#include <cmath>

#include "aureole/scene/contact_search.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/ray_state.h"

namespace aureole {

namespace {

using Body = InteriorList::Body;

/// A surface that the ray crosses.
struct Face {
  SurfacePoint point;
  Body body;
  bool inwards;

  Face(const SurfacePoint& p, const Vec3& d)
      : point(p), body{p.surface, p.instance}, inwards(dot(p.ng, d) < 0) {}
  const Surface& surface() const { return *point.surface; }
};

/// The faces within the offset of a ray's origin, beginning with the hit: at most kMost; further faces are
/// ignored.
class Faces {
public:
  static constexpr int kMost = 12;

  Faces(const Scene& scene, const Ray& ray, const RayTracer::Hit& hit) {
    const float size = length(ray.d);
    const Vec3 d = ray.d * (1 / size);
    add(scene.surface_point(hit, ray), d);
    const float reach = contact_distance(all_[0].point, d);
    // The error bound of another face may be larger than the bound of the hit. Faces before the hit count as
    // well: by rounding, a face at the hit's distance may lie in front of an interval that begins at the hit.
    constexpr float kReach = 16;
    thread_local std::vector<RayTracer::Hit> near;
    scene.tracer().all_hits({ray.o, ray.d, std::min(hit.t + kReach * reach / size, ray.t_max), ray.time},
                            hit.t - reach / size, near);
    for (const RayTracer::Hit& h : near) {
      if (h.shape == hit.shape && h.geometry == hit.geometry && h.primitive == hit.primitive) continue;
      const SurfacePoint point = scene.surface_point(h, ray);
      if ((h.t - hit.t) * size <= reach + contact_distance(point, d)) add(point, d);
    }
  }

  const Face* begin() const { return all_; }
  const Face* end() const { return all_ + count_; }
  int count() const { return count_; }
  /// The face at which the ray enters the body, or leaves it; null if there is none.
  const Face* of(const Body& body, bool inwards) const {
    return find([&](const Face& f) { return f.inwards == inwards && f.body == body; });
  }
  template <class Condition>
  const Face* find(Condition&& holds) const {
    const Face* found = std::find_if(begin(), end(), holds);
    return found == end() ? nullptr : found;
  }

private:
  void add(const SurfacePoint& point, const Vec3& d) {
    if (count_ < kMost) std::construct_at(&all_[count_++], point, d);
  }

  int count_ = 0;
  union {
    Face all_[kMost];
  };
};

/// The interface from one body to another, either of which may be missing: the face of one of the two bodies.
const Face* interface(const Faces& faces, const Body& before, const Body& behind) {
  const Face* out = before.surface ? faces.of(before, false) : nullptr;
  const Face* in = behind.surface ? faces.of(behind, true) : nullptr;
  if (!out || !in) return out ? out : in;
  if (out->surface().is_null() != in->surface().is_null()) return out->surface().is_null() ? in : out;
  if (out->surface().rank != in->surface().rank) return out->surface().rank > in->surface().rank ? out : in;
  // Both directions choose one face, so that paths may be followed backwards: a rough face where
  // the other one is smooth.
  constexpr Lobe kSpread = Lobe::diffuse | Lobe::glossy;
  if (has(out->surface().lobes, kSpread) != has(in->surface().lobes, kSpread))
    return has(out->surface().lobes, kSpread) ? out : in;
  return out->surface().body < in->surface().body ? out : in;
}

}  // namespace

bool find_contact(const Scene& scene, const Ray& ray, const RayTracer::Hit& hit, const RayState& state,
                  const Wavelengths& w, Contact& out) {
  const Faces faces(scene, ray, hit);
  if (faces.count() == 1) return false;
  const InteriorList& inside = state.interiors;
  const Face* opaque = faces.find([&](const Face& f) {
    return f.surface().is_opaque() && !(f.surface().rank != 0 && inside.hides(f.body));
  });
  const bool any_ranked = faces.find([](const Face& f) { return f.surface().rank != 0; });
  if (!opaque && !any_ranked) return false;
  out.across = inside;
  for (const bool inwards : {false, true})
    for (const Face& f : faces)
      // A body of which the ray crosses two faces, at an edge or where two parts of the body touch, fills the
      // space around the ray as before.
      if (f.surface().rank != 0 && f.inwards == inwards && !faces.of(f.body, !inwards))
        out.across.pass(f.body, inwards);
  const Body before = inside.filling(), behind = out.across.filling();
  out.medium = before == behind ? state.medium : medium_across(before, behind, state.medium);
  const Face* chosen = opaque;
  out.is_inactive = false;
  // Loading has noted a pane or a mask that lies on a body: light interacts with the body's surface alone.
  if (!chosen) {
    out.is_inactive =
        before == behind || (!before.surface && !behind.surface) ||
        (before.surface && behind.surface && have_same_index(*before.surface, *behind.surface, w));
    chosen = interface(faces, before, behind);
    if (!chosen) chosen = faces.begin(), out.is_inactive = true;
  }
  out.point = chosen->point;
  for (const Face& f : faces) out.point.p_error = max(out.point.p_error, f.point.p_error);
  return true;
}

}  // namespace aureole
