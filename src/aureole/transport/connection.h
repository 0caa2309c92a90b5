// SPDX-License-Identifier: Apache-2.0
// Connections: segments from a vertex of a path to a known point, or into a direction, with their visibility.
// This file has the only visibility tests, and the only march through null surfaces.
#pragma once

#include "aureole/scene/scene.h"
#include "aureole/transport/medium_segment.h"
#include "aureole/transport/path_limits.h"
#include "aureole/transport/ray_origin.h"
#include "aureole/transport/ray_state.h"

namespace aureole {

/// The result of following a ray.
enum class Event : std::uint8_t {
  surface,  ///< it leads to a vertex on a surface
  medium,   ///< it leads to a vertex in a medium
  entered,  ///< the path was refracted into a surface with a BSSRDF (transport/emerge.h)
  escape,   ///< it leaves the scene or reaches its target
  crossed,  ///< it has crossed a null surface or an interface between media and must be traced again
  blocked,  ///< it is occluded or absorbed
};

/// A segment whose visibility is tested. Its ray ends at t = 1 unless it is infinite, and need not have unit
/// length.
struct TestSegment : Segment {
  Vec3 d;            ///< unit direction
  Vec3 target;       ///< the far end, if there is one, off the surface that it lies on
  float end_offset;  ///< distance from `target` to the surface that it lies on
  bool infinite;
  bool through_emitters;  ///< surfaces of lights do not occlude it
  /// the march continues behind the occluder, to find `clear_passage`; `passage` is 0 then
  bool goes_behind;
  /// rays of the other techniques go on behind obstacles near edges that diffract light (`probability_behind`)
  bool others_go_behind;
  int crossings_left = kUnlimitedCrossings;  ///< crossings of surfaces that count for the limit of segments
  /// Transmittance so far, times the MIS weight of the estimate. In scenes with media `finish` completes it.
  Spectrum passage;
  /// `passage` without media and without the surfaces that transmit less than `kOpaque`
  Spectrum clear_passage;
  static constexpr float kOpaque = 0.01f;

  // In scenes with media (transport/medium_segment.h):
  std::uint32_t key;  ///< key of the random numbers along the segment
  /// Pdf of this connection and pdf of the other techniques that find it, both relative to the hero's pdf of
  /// the path. The pdf of the others is that in a clear medium.
  Spectrum own, other;
  Spectrum transmitted;         ///< transmittance of the media so far
  Spectrum transmitted_before;  ///< `transmitted` before the present medium
  /// the medium at the far end whose emission the connection carries; null: the connection carries emission
  /// of a surface
  const Medium* source;
  bool others_pass;  ///< the other techniques pass media with probability 1, as if the media were clear

  /// Sets a segment from a point along `direction` to another, off the surfaces that they lie on.
  void set(const RayOrigin& from, const Vec3& direction, const RayOrigin& to);
  /// Sets an infinite segment from a point along `direction`.
  void set(const RayOrigin& from, const Vec3& direction);
  /// Sets an infinite segment along a ray.
  void set(const Ray& ray);
  /// Sets the medium and the interior list at the origin of the segment, in scenes with media.
  void begin_in(const RayState& start, std::uint32_t random_key) {
    medium = start.medium, interiors = start.interiors, contact = nullptr;
    key = random_key, transmitted = transmitted_before = 1.f;
    source = nullptr;
    others_pass = false;
  }
  /// Sets the MIS weight by the pdfs `own_pdf` of this connection and `other_pdf` of all other techniques,
  /// relative to the hero's pdf of the path (balance heuristic over techniques and wavelengths). In scenes
  /// with media `finish` sets it, since the pdfs depend on the media along the segment.
  void weigh(bool has_media, const Spectrum& own_pdf, const Spectrum& other_pdf, const Wavelengths& w) {
    own = own_pdf, other = other_pdf;
    if (has_media)
      passage = Spectrum(1.f) / w.pdf;
    else
      passage = Spectrum(1.f) / (w.pdf * sum(own_pdf + other_pdf));
    clear_passage = passage;
  }
  /// Completes `passage` of a connection that is not occluded, in scenes with media.
  void finish() {
    if (source && medium != source) {
      passage = 0.f;
      return;
    }
    // A random walk finds the emission of a uniform medium at each of its scattering events there.
    const Spectrum& walked = source && !source->majorants() ? transmitted_before : transmitted;
    passage *= transmitted * (1 / sum(own + (others_pass ? other : other * walked)));
  }
  /// Marks a connection that cannot be traced: its sample is invalid, and is counted as such.
  void lose() { passage = std::numeric_limits<float>::quiet_NaN(); }
  float distance() const { return infinite ? kInfinity : length(target - origin); }
};

/// A connection of a path: `far` is the light that arrives at its far end, `near` the map of light from there
/// to the film.
template <class L>
struct BasicConnection : TestSegment {
  typename L::Weight near;
  typename L::Light far;

  /// The estimate of the connection, per wavelength.
  Spectrum estimate() const { return L::measured(near.of(L::scaled(far, passage))); }
};
using Connection = BasicConnection<Unpolarised>;

/// Advances a segment to the distance `t` along its ray and attenuates it by the medium that the ray is in.
/// `emission` has the meaning of the parameter of `transmittance`.
void travel(TestSegment& segment, float t, const Wavelengths& w, SegmentEmission* emission = nullptr);

/// Processes a surface that a segment has hit: returns `crossed`, `blocked`, or `escape` where the segment's
/// far end lies on that surface.
Event cross(const SurfacePoint& point, TestSegment& segment, const Wavelengths& w);

/// Processes a surface that a segment has hit, as above, where other surfaces may touch it. Calls
/// `meet(point)` before.
template <class Meet>
Event cross(const Scene& scene, const RayTracer::Hit& hit, TestSegment& c, const Wavelengths& w,
            Meet&& meet) {
  if (scene.has_contacts() && scene.surfaces().of(hit).touches) {
    Contact contact;
    if (find_contact(scene, c.ray, hit, c, w, contact)) {
      c.contact = &contact;
      meet(contact.point);
      const Event event = cross(contact.point, c, w);
      c.contact = nullptr;
      return event;
    }
  }
  const SurfacePoint point = scene.surface_point(hit, c.ray);
  meet(point);
  return cross(point, c, w);
}

/// Advances a segment through the medium to the hit of the ray tracer, and processes the surface there.
inline Event cross(const Scene& scene, const RayTracer::Hit& hit, TestSegment& c, const Wavelengths& w) {
  if (hit.is_lost()) return c.lose(), Event::escape;
  if (scene.has_media() && c.medium) travel(c, hit ? hit.t : c.ray.t_max, w);
  if (!hit) return Event::escape;
  return cross(scene, hit, c, w, [](const SurfacePoint&) {});
}

/// Whether a segment that seems occluded could not be traced; then it counts as visible, with an invalid
/// passage.
bool is_lost(const Scene& scene, TestSegment& segment);

/// Tests the visibility of one segment; true where its far end is visible; `passage` is then complete except
/// for the diffraction factor. `Driver` tests the connections of a batch together.
bool is_visible(const Scene& scene, TestSegment& segment, const Wavelengths& w);

inline void TestSegment::set(const RayOrigin& from, const Vec3& direction, const RayOrigin& to) {
  origin = from.p;
  ray.o = offset_origin(from.p, from.p_error, from.ng, direction);
  // The far endpoint is offset from its surface as well, so that the segment needs no shortening by a
  // constant. The offset includes the rounding of the ray's own arithmetic, gamma(10) of each of direction,
  // distance and differences of the segment's length.
  const Vec3 error = to.p_error + (abs(ray.o) + abs(to.p) + abs(to.p - ray.o)) * gamma_bound(10);
  target = offset_origin(to.p, error, to.ng, -direction);
  ray.d = target - ray.o, ray.t_max = 1;
  d = direction;
  offset = distance_from_surface(ray.o - from.p, direction);
  end_offset = distance_from_surface(target - to.p, direction);
  infinite = through_emitters = goes_behind = others_go_behind = false;
  crossings_left = kUnlimitedCrossings;
}

inline void TestSegment::set(const RayOrigin& from, const Vec3& direction) {
  set(from.spawn(direction));
  origin = from.p, offset = from.offset(ray);
}

inline void TestSegment::set(const Ray& r) {
  ray = r;
  origin = r.o, d = r.d;
  offset = end_offset = 0;
  infinite = true, through_emitters = goes_behind = others_go_behind = false;
  crossings_left = kUnlimitedCrossings;
}

}  // namespace aureole
