// SPDX-License-Identifier: Apache-2.0
// The sensor family: which rays reach a point of the film.
#pragma once

#include <optional>

#include "aureole/film/film.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"

namespace aureole {

class Shape;

struct SensorRay {
  Ray ray;
  float weight = 1;  ///< what the radiance along the ray counts for
};

/// A point of the aperture as seen from a point of the scene.
struct SensorConnection {
  Vec3 wo;    ///< unit direction from the reference point towards the aperture
  Vec3 p;     ///< where the ray of Sensor::sample_ray starts: the segment up to here must be free
  Vec2 film;  ///< where the light would fall, as in Sensor::sample_ray
  /// Area of film [pixels^2] per area across `wo` at the reference point [1/m^2], over the density of the
  /// choice of p: radiance leaving the reference point times |cos| there times this is what falls on the film
  /// per area [m^2] of surface.
  float importance = 0;
};

/// The part of a film that a sensor fills: all of it, but for the sensors of a batch. In pixels from the
/// film's top left corner.
struct FilmPart {
  float left = 0, width = 1, height = 1;
  Vec2 lower, upper;  ///< of the places where rays start: the crop and, with sample_border, its border

  static FilmPart of(const Film& film, int index, int count);
  bool samples(Vec2 p) const { return p.x >= lower.x && p.y >= lower.y && p.x <= upper.x && p.y <= upper.y; }
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

  /// Called where the sensor is a child of `shape`. Throws Error for a sensor that can't sit on a shape.
  virtual void attach(const Shape& shape);
  /// Called once with the scene's bounds before anything is sampled.
  virtual void set_scene_bounds(const Vec3& /*center*/, float /*radius*/) {}
  /// Makes the sensor fill part `index` of `count` equal parts of `film`, side by side, instead of a film of
  /// its own.
  virtual void share_film(const std::shared_ptr<Film>& film, int index, int count);

  /// Where on the film a point of the scene is seen, for light tracing; nothing where it is not seen, or by a
  /// sensor that light cannot be connected to.
  virtual std::optional<SensorConnection> sample_direct(const Vec3& /*reference*/, Vec2 /*lens*/) const {
    return {};
  }

  const Film& film() const { return *film_; }
  const Sampler& sampler() const { return *sampler_; }
  /// It measures one number, not a picture.
  bool is_meter() const { return measures_ == Measures::value; }

protected:
  enum class Measures { picture, value };
  /// Reads what every sensor has: film (default: hdrfilm), sampler (default: sobol), srf and shutter times.
  /// The film of a meter has one pixel and no reconstruction filter, which would weight its samples by their
  /// place.
  void read_common(const Properties& properties, Measures measures = Measures::picture);

  /// The unit vector along v, the value of a parameter. Throws Error for zero.
  static Vec3 unit_direction(const Properties& properties, std::string_view name, const Vec3& v);

  const FilmPart& part() const { return part_; }
  const std::shared_ptr<Film>& shared_film() const { return film_; }

private:
  std::shared_ptr<Film> film_;
  std::shared_ptr<Sampler> sampler_;
  FilmPart part_;
  Measures measures_ = Measures::picture;
};

}  // namespace aureole
