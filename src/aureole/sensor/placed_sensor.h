// SPDX-License-Identifier: Apache-2.0
// `PlacedSensor`: a sensor together with its position in the scene.
#pragma once

#include <memory>
#include <vector>

#include "aureole/sensor/sensor.h"

namespace aureole {

/// A sensor with the scene and film data that its methods need. The member functions pass these data to the
/// sensor.
struct PlacedSensor {
  const Sensor* sensor = nullptr;
  std::shared_ptr<const ShapeArea> area;  ///< the shape on which the sensor sits, or null
  /// The scene's bounding sphere.
  Vec3 scene_center;
  float scene_radius = 1;
  FilmPart part;

  // A camera's projection onto its part of the film, set by `Sensor::fit`.
  Vec2 film_center;      ///< where the optical axis intersects the film [pixels]
  float pixel_size = 1;  ///< width of a pixel on the picture plane at distance 1, or in a parallel projection
  float pixels_per_area = 1;  ///< film area over the area perpendicular to the rays, for a parallel
                              ///< projection

  /// Areas of the cells of a power map on a shape, row by row [square of the scene's unit]; null for other sensors, whose
  /// pixels have equal areas or none.
  std::shared_ptr<const std::vector<float>> cell_areas;

  std::vector<PlacedSensor> members;  ///< the sensors of a batch
  const Motion* motion = nullptr;     ///< of the sensor; null: it stands still

  /// Places a sensor that has its own film.
  static PlacedSensor of(const Sensor& sensor, std::shared_ptr<const ShapeArea> area,
                         const Vec3& scene_center, float scene_radius);

  // `time` [s] matters for sensors that move.
  SensorRay sample_ray(Vec2 film_position, Vec2 lens, float time = 0) const {
    const SensorRay ray = sensor->sample_ray(*this, film_position, lens);
    return motion ? moved(ray, time) : ray;
  }
  SensorRay sample_dispersed_ray(Vec2 film_position, Vec2 lens, float time, float nm) const {
    const SensorRay ray = sensor->sample_dispersed_ray(*this, film_position, lens, nm);
    return motion ? moved(ray, time) : ray;
  }
  bool disperses() const { return sensor->disperses(); }
  bool uses_lens() const { return sensor->uses_lens(); }
  std::optional<SensorConnection> sample_direct(const Vec3& reference, Vec2 lens, float time = 0) const {
    if (motion) return sample_direct_moved(reference, lens, time);
    return sensor->sample_direct(*this, reference, lens);
  }
  std::optional<SensorResponse> eval(const Vec3& p, const Vec3& d, std::optional<Vec2> seen = {},
                                     float time = 0) const {
    if (motion) return eval_moved(p, d, seen, time);
    return sensor->eval(*this, p, d, seen);
  }
  std::optional<Receiver> receiver(Vec2 film_position) const {
    return sensor->receiver(*this, film_position);
  }
  /// Calls f with each `Sensor::crossing` of the ray; for a batch there is at most one crossing for each of
  /// its sensors.
  template <class F>
  void for_crossings(const Ray& light, const F& f) const {
    if (const auto crossing = sensor->crossing(*this, light)) f(*crossing);
    for (const PlacedSensor& member : members) member.for_crossings(light, f);
  }
  std::optional<PinholeView> pinhole() const { return sensor->pinhole(*this); }
  bool counts_crossings() const { return sensor->counts_crossings(); }
  const Film& film() const { return sensor->film(); }
  const Sampler& sampler() const { return sensor->sampler(); }
  const Properties& properties() const { return sensor->properties(); }

private:
  /// From the sensor's place at its first key frame to that at a time; a rotation and a translation.
  Transform moved_to(float time) const;
  SensorRay moved(SensorRay ray, float time) const;
  std::optional<SensorConnection> sample_direct_moved(const Vec3& reference, Vec2 lens, float time) const;
  std::optional<SensorResponse> eval_moved(const Vec3& p, const Vec3& d, std::optional<Vec2> seen,
                                           float time) const;
};

}  // namespace aureole
