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
  float end_offset;  ///< distance from `target` to that surface
  bool infinite;
  bool through_emitters;  ///< surfaces of lights do not occlude it
  bool
      goes_behind;  ///< the march goes on behind what blocks it, to find `clear_passage`; `passage` is 0 then
  int crossings_left = kUnlimitedCrossings;  ///< crossings of surfaces that count for the limit of segments
  /// Transmittance so far, times the MIS weight of the estimate. In scenes with media `finish` completes it.
  Spectrum passage;
  Spectrum
      clear_passage;  ///< `passage` without surfaces that pass less than `kOpaque` of the light, and without media
  static constexpr float kOpaque = 0.01f;

  // In scenes with media (transport/medium_segment.h):
  std::uint32_t key;  ///< for random numbers
  /// Pdfs, relative to the hero's pdf of the path, of this connection and of the other techniques that find
  /// it, the latter as if the medium were clear.
  Spectrum own, other;
  Spectrum transmitted;         ///< transmittance of the media so far
  Spectrum transmitted_before;  ///< `transmitted` before the present medium
  const Medium* source;  ///< the medium whose emission it brings, which must be at its end; null: a surface
  bool others_pass;      ///< other techniques pass media with certainty, as if these were clear

  /// Sets a segment from a point along `direction` to another, off the surfaces that they lie on.
  void set(const RayOrigin& from, const Vec3& direction, const RayOrigin& to);
  /// Sets an infinite segment from a point along `direction`.
  void set(const RayOrigin& from, const Vec3& direction);
  /// Sets an infinite segment along a ray.
  void set(const Ray& ray);
  /// Sets the medium and the interiors where it begins, in scenes with media.
  void begin_in(const RayState& start, std::uint32_t random_key) {
    medium = start.medium, interiors = start.interiors, contact = nullptr;
    key = random_key, transmitted = transmitted_before = 1.f;
    source = nullptr;
    others_pass = false;
  }
  /// Sets the MIS weight by the pdfs `own_pdf` of this connection and `other_pdf` of all other techniques,
  /// relative to the hero's pdf of the path (balance heuristic over techniques and wavelengths). With media
  /// `finish` does, since pdfs depend on what lies between.
  void weigh(bool has_media, const Spectrum& own_pdf, const Spectrum& other_pdf, const Wavelengths& w) {
    own = own_pdf, other = other_pdf;
    if (has_media)
      passage = Spectrum(1.f) / w.pdf;
    else
      passage = Spectrum(1.f) / (w.pdf * sum(own_pdf + other_pdf));
    clear_passage = passage;
  }
  /// Completes `passage` where the connection is not occluded, in scenes with media.
  void finish() {
    if (source && medium != source) {
      passage = 0.f;
      return;
    }
    // A walk finds the emission of a uniform medium wherever it is scattered there.
    const Spectrum& walked = source && !source->majorants() ? transmitted_before : transmitted;
    passage *= transmitted * (1 / sum(own + (others_pass ? other : other * walked)));
  }
  /// The connection cannot be traced: the sample is invalid, which is counted.
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

/// Moves a segment on to the distance `t` along its ray: attenuates it by the medium that it is in.
/// `emission` as of `transmittance`.
void travel(TestSegment& segment, float t, const Wavelengths& w, SegmentEmission* emission = nullptr);

/// A segment has hit a surface: crossed, blocked, or escape where its end lies on that surface, too.
Event cross(const SurfacePoint& point, TestSegment& segment, const Wavelengths& w);

/// A segment has hit a surface: as above, where others may touch it. Calls `meet(point)` before.
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

/// Moves a segment on to what the ray tracer has found, through the media before it.
inline Event cross(const Scene& scene, const RayTracer::Hit& hit, TestSegment& c, const Wavelengths& w) {
  if (hit.is_lost()) return c.lose(), Event::escape;
  if (scene.has_media() && c.medium) travel(c, hit ? hit.t : c.ray.t_max, w);
  if (!hit) return Event::escape;
  return cross(scene, hit, c, w, [](const SurfacePoint&) {});
}

/// Whether a segment that seems occluded could not be traced; then it counts as visible, with an invalid
/// passage.
bool is_lost(const Scene& scene, TestSegment& segment);

/// Tests the visibility of one segment; true where its far end is visible, and `passage` complete but for the
/// diffraction factor. Those of a batch: `connect_vertices` of the driver.
bool is_visible(const Scene& scene, TestSegment& segment, const Wavelengths& w);

inline void TestSegment::set(const RayOrigin& from, const Vec3& direction, const RayOrigin& to) {
  origin = from.p;
  ray.o = offset_origin(from.p, from.p_error, from.ng, direction);
  // The far end leaves its surface, too, so that the segment needs no shortening by a constant. The rounding
  // of the ray's own arithmetic counts: direction, distance and differences of the length of the segment,
  // gamma(10) of each.
  const Vec3 error = to.p_error + (abs(ray.o) + abs(to.p) + abs(to.p - ray.o)) * gamma_bound(10);
  target = offset_origin(to.p, error, to.ng, -direction);
  ray.d = target - ray.o, ray.t_max = 1;
  d = direction;
  offset = distance_from_surface(ray.o - from.p, direction);
  end_offset = distance_from_surface(target - to.p, direction);
  infinite = through_emitters = goes_behind = false;
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
  infinite = true, through_emitters = goes_behind = false;
  crossings_left = kUnlimitedCrossings;
}

}  // namespace aureole
