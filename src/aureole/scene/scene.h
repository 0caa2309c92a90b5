// SPDX-License-Identifier: Apache-2.0
// `Scene`: surfaces, lights, sensor and acceleration structure, ready for rendering. It is independent of
// file formats and integrators.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/scene/exposure_times.h"
#include "aureole/scene/interior_list.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/ray_tracer.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/scene/scene_surfaces.h"
#include "aureole/scene/scene_tables.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

class EmittingMedia;
class OutlineEdges;
class SceneDiffraction;
struct DiffractionInput;

class Scene {
public:
  /// Builds the surfaces, the ray tracer, the light sampler and the distribution of wavelengths. It reuses
  /// unchanged acceleration structures of `reuse`, a scene that may be rendering meanwhile. It reuses all of
  /// them if only BSDFs, lights, sensors or textures differ. Throws Error if there is no sensor or if an
  /// object has invalid numbers.
  explicit Scene(SceneParts parts, const Scene* reuse = nullptr);
  // A scene can be neither copied nor moved: lights and surfaces hold pointers into it.
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const SceneSurfaces& surfaces() const { return surfaces_; }
  /// Returns the nearest surface point along a ray.
  std::optional<SurfacePoint> intersect(const Ray& ray) const { return surfaces_.intersect(ray); }
  /// Returns the surface point of a hit found by the ray tracer.
  SurfacePoint surface_point(const RayTracer::Hit& hit, const Ray& ray) const {
    return surfaces_.surface_point(hit, ray);
  }
  const RayTracer& tracer() const { return *surfaces_.tracer; }
  /// Returns false if a ray intersects no emitter's bounds: a ray that only gathers emission need not be
  /// traced then.
  bool may_meet_emitter(const Ray& ray) const { return emits_everywhere_ || may_meet_shining_shape(ray); }
  /// Returns false if a ray intersects no emissive shape's bounds. Environment emitters and media are not
  /// considered.
  bool may_meet_shining_shape(const Ray& ray) const;
  /// Whether every segment is either visible or occluded, so that an occlusion query is enough.
  bool has_binary_visibility() const { return surfaces_.has_binary_visibility(); }
  /// Whether some space is not vacuum, bodies have a rank, or surfaces touch bodies: paths then track their current
  /// medium.
  bool has_media() const { return has_media_; }
  /// The media of the sensor, of lights and of both sides of surfaces, each once.
  const std::vector<const Medium*>& media() const { return media_; }
  /// Whether surfaces touch each other where a body begins or ends (scene/contact_search.h).
  bool has_contacts() const { return has_contacts_; }
  /// Whether lights, the sensor or shapes change over time: paths then have a time during the exposure.
  bool changes() const { return changes_; }
  /// Whether light may enter a surface at one point and leave it at another (subsurface scattering).
  bool has_exits() const { return has_exits_; }
  /// Whether light sampling from points in the medium can succeed. False if opaque or refracting surfaces,
  /// without straight transmission, enclose the medium and all lights are outside of them.
  bool lights_reach(const Medium& medium) const {
    for (const Closed& c : closed_)
      if (c.medium == &medium) return c.lights_inside;
    return true;
  }
  /// Whether a straight segment between a point in the medium and `p` can be unoccluded. False if `p` is
  /// outside the surfaces described at `lights_reach`.
  bool may_see(const Medium& medium, const Vec3& p) const {
    for (const Closed& c : closed_)
      if (c.medium == &medium) return c.may_contain(p);
    return true;
  }
  /// Returns the medium at the origin of a ray, null for vacuum, given the bodies with a rank that contain it
  /// (`shapes_around`). It is determined from the next surface along the ray that bounds a medium and lies in no
  /// other body with a rank.
  const Medium* medium_at(const Ray& ray, const InteriorList& inside) const;
  const Medium* medium_at(const Ray& ray) const {
    InteriorList inside;
    shapes_around(ray, inside);
    return medium_at(ray, inside);
  }
  /// Adds to `inside` the bodies with a rank that contain the origin of a ray.
  void shapes_around(const Ray& ray, InteriorList& inside) const;

  /// The pdf of times where lights are modulated by much; null: times are even.
  const ExposureTimes* exposure_times() const { return exposure_times_.get(); }

  const PlacedSensor& sensor() const { return sensor_; }
  const Film& film() const { return sensor_.film(); }
  const SceneParts& parts() const { return parts_; }
  const std::vector<Light>& emitters() const { return emitters_; }
  /// Emitters at infinity that a ray leaving the scene can hit, which excludes delta emitters.
  const std::vector<const Light*>& infinite_emitters() const { return infinite_; }
  const LightSampler& lights() const { return lights_; }
  /// The emissive media that fill a volume; null if there are none.
  const EmittingMedia* emitting_media() const { return emitting_media_.get(); }
  /// Data for diffraction at edges by the model "beams"; null if the scene does not use this model.
  const SceneDiffraction* diffraction() const { return diffraction_.get(); }
  /// The edges of the diffraction model "segments"; null if the scene does not use this model.
  const OutlineEdges* outline_edges() const { return outline_edges_.get(); }
  const WavelengthDistribution& wavelengths() const { return *wavelengths_; }
  Bounds3 bounds() const { return surfaces_.tracer->bounds(); }
  /// Tables that integrators derive from this scene.
  SceneTables& tables() const { return tables_; }
  /// Notes for the user about the whole scene.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  /// Throws Error if the sensor's rays cannot be traced. `places` is the bounding box of the objects in the
  /// scene.
  void place_sensor(Bounds3 places) const;
  /// Adds a note for each camera whose clip planes hide all shapes.
  void note_clipping();
  void make_lights();
  /// Appends the lights of an instance. Throws Error for one that is scaled or mirrored.
  void make_lights_of(const Primitive& instance);
  void make_surfaces();
  void find_media();
  void bound_emitters();
  void weigh_lights();
  /// Chooses the pdf of times by the powers of the lights.
  /// The mean over the exposure of the factor by which a light is modulated, and at least a small number.
  double mean_modulation(const Light& light) const;
  void choose_times(std::span<const double> powers);
  DiffractionInput diffraction_input() const;
  /// Finds the emissive media and appends their power spectra to `powers`.
  void find_emitting_media(const SampledSpectrum& response, std::vector<SampledSpectrum>& powers);
  void find_closed_media();
  void look_for_contacts();
  bool faces_outwards(std::size_t part) const;
  /// Places instances that move at the times of the exposure.
  void set_in_motion();
  /// Finds out whether anything changes over time, and notes exposures that have no effect.
  void find_changes();
  /// Throws Error if the sensor is in a medium that the medium's surfaces do not enclose.
  void check_sensor_medium() const;

  SceneParts parts_;
  SceneSurfaces surfaces_;
  /// All emitters: those on shapes first, in the order of the shapes, then those of instances, in their order, then the others.
  std::vector<Light> emitters_;
  std::vector<std::unique_ptr<const LightMotion>> light_motions_;  ///< of lights that move, and of instances
  std::vector<const Light*> infinite_;
  PlacedSensor sensor_;
  LightSampler lights_;
  std::shared_ptr<const EmittingMedia> emitting_media_;
  std::shared_ptr<const SceneDiffraction> diffraction_;
  std::shared_ptr<const OutlineEdges> outline_edges_;
  std::unique_ptr<WavelengthDistribution> wavelengths_;
  std::unique_ptr<const ExposureTimes> exposure_times_;
  std::vector<Bounds3> emitter_bounds_;  ///< bounds of the emissive shapes, if they are few
  bool many_shapes_shine_ = false, emits_everywhere_ = false;
  bool has_exits_ = false, has_contacts_ = false, changes_ = false;
  std::vector<const Medium*> media_;
  bool has_media_ = false, any_medium_outside_ = false, any_medium_emits_ = false;
  /// A medium that lies inside closed surfaces without straight transmission, and the box around them.
  struct Closed {
    const Medium* medium;
    Bounds3 box;
    bool lights_inside;
    bool is_ranked;  ///< whether a surface of the medium belongs to a body with a rank
    bool may_contain(const Vec3& p) const;
  };
  std::vector<Closed> closed_;
  Bounds3 media_bounds_;   ///< bounds of the surfaces at which a medium begins or ends
  Bounds3 ranked_bounds_;  ///< bounds of the bodies with a rank
  std::vector<std::string> notes_;
  mutable SceneTables tables_;
};

}  // namespace aureole
