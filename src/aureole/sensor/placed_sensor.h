// SPDX-License-Identifier: Apache-2.0
// `PlacedSensor`: a sensor in its place.
#pragma once

#include <memory>
#include <vector>

#include "aureole/sensor/sensor.h"

namespace aureole {

/// A sensor together with the scene and film data that its methods need. The member functions forward to the
/// sensor with these data.
struct PlacedSensor {
  const Sensor* sensor = nullptr;
  std::shared_ptr<const ShapeArea> area;  ///< of the shape that it sits on, or null
  /// The scene's bounding sphere.
  Vec3 scene_center;
  float scene_radius = 1;
  FilmPart part;

  // A camera's projection onto its part of the film (`Sensor::fit`).
  Vec2 film_center;           ///< where its axis meets the film [pixels]
  float pixel_size = 1;       ///< of the picture plane at distance 1, or of a parallel projection
  float pixels_per_area = 1;  ///< of film over the area across the rays, of a parallel projection

  std::vector<PlacedSensor> members;  ///< of a batch

  /// Of a sensor that has a film of its own.
  static PlacedSensor of(const Sensor& sensor, std::shared_ptr<const ShapeArea> area,
                         const Vec3& scene_center, float scene_radius);

  SensorRay sample_ray(Vec2 film_position, Vec2 lens) const {
    return sensor->sample_ray(*this, film_position, lens);
  }
  bool uses_lens() const { return sensor->uses_lens(); }
  std::optional<SensorConnection> sample_direct(const Vec3& reference, Vec2 lens) const {
    return sensor->sample_direct(*this, reference, lens);
  }
  std::optional<SensorResponse> eval(const Vec3& p, const Vec3& d, std::optional<Vec2> seen = {}) const {
    return sensor->eval(*this, p, d, seen);
  }
  std::optional<Receiver> receiver(Vec2 film_position) const {
    return sensor->receiver(*this, film_position);
  }
  /// Calls f with each `Sensor::crossing` of the ray: of a batch one for each of its sensors, at most.
  template <class F>
  void for_crossings(const Ray& light, const F& f) const {
    if (const auto crossing = sensor->crossing(*this, light)) f(*crossing);
    for (const PlacedSensor& member : members) member.for_crossings(light, f);
  }
  bool counts_crossings() const { return sensor->counts_crossings(); }
  const Film& film() const { return sensor->film(); }
  const Sampler& sampler() const { return sensor->sampler(); }
  const Properties& properties() const { return sensor->properties(); }
};

}  // namespace aureole
