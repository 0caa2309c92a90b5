// SPDX-License-Identifier: Apache-2.0
// The sensor family: which rays reach a point of the film.
#pragma once

#include <optional>

#include "aureole/film/film.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"

namespace aureole {

struct SensorRay {
  Ray ray;
  float weight = 1;  ///< what the radiance along the ray counts for
};

/// A point of the aperture as seen from a point of the scene.
struct SensorConnection {
  Vec3 wo;    ///< unit direction from the reference point towards the aperture
  Vec3 p;     ///< on the aperture
  Vec2 film;  ///< where the light would fall, as in Sensor::sample_ray
  /// Area of film [pixels^2] per area across `wo` at the reference point [1/m^2], over the density of the
  /// choice of p: radiance leaving the reference point times |cos| there times this is what falls on the film
  /// per area [m^2] of surface.
  float importance = 0;
};

class Sensor : public Object {
public:
  static constexpr const char* kFamily = "a sensor";
  using Object::Object;

  /// The ray seen at `film_position` (pixels from the film's top left corner, not the crop's); `lens` chooses
  /// a point of the aperture.
  virtual SensorRay sample_ray(Vec2 film_position, Vec2 lens) const = 0;
  /// Whether sample_ray looks at `lens`: two dimensions of the sampler.
  virtual bool uses_lens() const { return false; }

  /// Called once with the scene's bounds before anything is sampled.
  virtual void set_scene_bounds(const Vec3& /*center*/, float /*radius*/) {}

  /// Where on the film a point of the scene is seen, for light tracing; nothing where it is not seen, or by a
  /// sensor that light cannot be connected to.
  virtual std::optional<SensorConnection> sample_direct(const Vec3& /*reference*/, Vec2 /*lens*/) const {
    return {};
  }

  const Film& film() const { return *film_; }
  const Sampler& sampler() const { return *sampler_; }

protected:
  /// Reads the children film (default: hdrfilm) and sampler (default: sobol).
  void read_common(const Properties& properties);

private:
  std::shared_ptr<Film> film_;
  std::shared_ptr<Sampler> sampler_;
};

}  // namespace aureole
