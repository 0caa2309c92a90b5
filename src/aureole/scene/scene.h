// SPDX-License-Identifier: Apache-2.0
// `Scene`: surfaces, lights, sensor and acceleration structure, ready for rendering. It knows no file format
// and no integrator.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/scene/interior_list.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/ray_tracer.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/scene/scene_surfaces.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

class EmittingMedia;
class SceneDiffraction;
struct DiffractionInput;

class Scene {
public:
  /// Builds the surfaces, the ray tracer, the lights with their tree and the density of wavelengths. Reuses
  /// unchanged structures of the ray tracer of `reuse`, a scene that may be rendering meanwhile: all of them
  /// if only BSDFs, lights, sensors or textures differ. Throws Error where there is no sensor, or an object
  /// with invalid numbers.
  explicit Scene(SceneParts parts, const Scene* reuse = nullptr);
  // Neither copied nor moved: lights and surfaces hold pointers into it.
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const SceneSurfaces& surfaces() const { return surfaces_; }
  /// The nearest surface point along a ray.
  std::optional<SurfacePoint> intersect(const Ray& ray) const { return surfaces_.intersect(ray); }
  /// The point that the ray tracer has hit.
  SurfacePoint surface_point(const RayTracer::Hit& hit, const Ray& ray) const {
    return surfaces_.surface_point(hit, ray);
  }
  const RayTracer& tracer() const { return *surfaces_.tracer; }
  /// False where a ray misses the bounds of all emitters, so that a ray that can only find emission need not
  /// be traced.
  bool may_meet_emitter(const Ray& ray) const { return emits_everywhere_ || may_meet_shining_shape(ray); }
  /// False where a ray misses the bounds of all shapes that emit; environments and media do not count.
  bool may_meet_shining_shape(const Ray& ray) const;
  /// Every connection is either visible or occluded, so that an occlusion query is enough.
  bool has_binary_visibility() const { return surfaces_.has_binary_visibility(); }
  /// Some space is not vacuum, or shapes overlap by priority: paths keep account of what they are in.
  bool has_media() const { return has_media_; }
  /// Light may leave surfaces elsewhere than it has entered them.
  bool has_exits() const { return has_exits_; }
  /// Whether any light can be connected with a place in the medium. False where the medium lies within closed
  /// surfaces that let nothing pass straight, and all lights are elsewhere.
  bool lights_reach(const Medium& medium) const {
    for (const Closed& c : closed_)
      if (c.medium == &medium) return c.lights_inside;
    return true;
  }
  /// Whether a place in the medium can be connected with `p`. False where such surfaces are between them.
  bool may_see(const Medium& medium, const Vec3& p) const {
    for (const Closed& c : closed_)
      if (c.medium == &medium) return c.may_contain(p);
    return true;
  }
  /// The medium at the origin of a ray, or null, as the next surface without priority says at which a medium
  /// ends.
  const Medium* medium_at(const Ray& ray) const;
  /// The closed shapes with a priority that the origin of a ray lies in.
  void shapes_around(const Ray& ray, InteriorList& inside) const;

  const PlacedSensor& sensor() const { return sensor_; }
  const Film& film() const { return sensor_.film(); }
  const SceneParts& parts() const { return parts_; }
  const std::vector<Light>& emitters() const { return emitters_; }
  /// Emitters at infinity that rays leaving the scene may see.
  const std::vector<const Light*>& infinite_emitters() const { return infinite_; }
  const LightSampler& lights() const { return lights_; }
  /// The media that emit, of those that fill something; null: none.
  const EmittingMedia* emitting_media() const { return emitting_media_.get(); }
  /// Data for diffraction; null: light is not diffracted.
  const SceneDiffraction* diffraction() const { return diffraction_.get(); }
  const WavelengthDistribution& wavelengths() const { return *wavelengths_; }
  Bounds3 bounds() const { return surfaces_.tracer->bounds(); }
  /// Notes for the user about the scene as a whole.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  /// Throws where rays of the sensor cannot be traced. `places`: of the objects in the scene.
  void place_sensor(Bounds3 places) const;
  void make_lights();
  void make_surfaces();
  void find_media();
  void bound_emitters();
  void weigh_lights();
  DiffractionInput diffraction_input() const;
  /// Adds the spectra of their powers.
  void find_emitting_media(const SampledSpectrum& response, std::vector<SampledSpectrum>& powers);
  void find_closed_media();
  bool faces_outwards(std::size_t part) const;
  /// Throws Error where the sensor is in a medium that its surfaces do not close.
  void check_sensor_medium() const;

  SceneParts parts_;
  SceneSurfaces surfaces_;
  std::vector<Light> emitters_;  ///< emitters of shapes first, in their order
  std::vector<const Light*> infinite_;
  PlacedSensor sensor_;
  LightSampler lights_;
  std::shared_ptr<const EmittingMedia> emitting_media_;
  std::shared_ptr<const SceneDiffraction> diffraction_;
  std::unique_ptr<WavelengthDistribution> wavelengths_;
  std::vector<Bounds3> emitter_bounds_;  ///< of shapes that emit, where they are few
  bool many_shapes_shine_ = false, emits_everywhere_ = false;
  bool has_exits_ = false;
  bool has_media_ = false, any_medium_outside_ = false, any_medium_emits_ = false;
  /// A medium that lies within closed surfaces which let no light pass straight, all within the box.
  struct Closed {
    const Medium* medium;
    Bounds3 box;
    bool lights_inside;
    bool may_contain(const Vec3& p) const;
  };
  std::vector<Closed> closed_;
  Bounds3 media_bounds_;     ///< of the surfaces on which a medium ends
  Bounds3 priority_bounds_;  ///< of those with a priority
  std::vector<std::string> notes_;
};

}  // namespace aureole
