// SPDX-License-Identifier: Apache-2.0
// The sensor family: which rays reach a point of the film. A sensor holds the measurement model; scene and
// film data are in a `PlacedSensor` (placed_sensor.h), which is passed to its methods.
#pragma once

#include <optional>

#include "aureole/film/film.h"
#include "aureole/medium/medium.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"

namespace aureole {

class ShapeArea;
struct PlacedSensor;

struct SensorRay {
  Ray ray;
  float weight = 1;  ///< factor of the radiance along the ray
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

/// The response of a sensor to a given ray: the inverse of Sensor::sample_ray.
struct SensorResponse {
  Vec2 film;         ///< where the ray is seen
  float weight = 1;  ///< factor of the radiance along it
  // Densities with which sample_ray chooses the ray for uniform positions on its part of the film and on the
  // lens.
  float pdf_position = 0;   ///< of the point of the aperture [1/m^2], or a mass where that is one point
  float pdf_direction = 0;  ///< [1/sr], or a mass where that is one direction
  /// Of the rays from that point of the aperture, or of those of that one direction: the density with which they
  /// pass the given point, per area across the ray [1/m^2].
  float pdf_across = 0;
};

/// A point at which a sensor measures the light that arrives from all directions, or from those of a half-space.
struct Receiver {
  /// The irradiance, on the side of the normal; or the fluence rate, which does not ask where light comes from.
  enum class Measure { irradiance, fluence };

  Vec3 p;
  Vec3 p_error;  ///< bound of the rounding error of p; zero for a point that lies on no surface
  Vec3 ng;       ///< unit normal
  Measure measure = Measure::fluence;
  float weight = 1;  ///< factor of its response, where places are not chosen as they count

  /// Factor of the radiance that arrives against the unit direction `d`.
  float response(const Vec3& d) const;
  /// The integral of the response over all directions.
  float total() const;
  /// The density of `sample_ray` [1/sr]: the response over its integral, without the weight of either.
  float pdf(const Vec3& d) const;
  /// The side from which it measures: its normal, or zero.
  Vec3 facing() const { return measure == Measure::irradiance ? ng : Vec3{}; }

  /// A ray in proportion to the response; its weight is `total`.
  SensorRay sample_ray(Vec2 u) const;
  /// As `Sensor::sample_direct` for the receiver at `film`, which had been chosen uniformly from `film_area`
  /// [pixels^2]. Nothing where it does not measure light from there.
  std::optional<SensorConnection> connect(const Vec3& reference, Vec2 film, float film_area) const;
};

/// Where light on its way passes the receivers of a sensor.
struct SensorCrossing {
  Vec3 p;
  Vec2 film;  ///< as in Sensor::sample_ray
  /// Area of film [pixels^2] per area of the receivers' plane [1/m^2] times response over |cos|: the power of the
  /// ray times this is what falls on the film.
  float importance;
};

/// The part of a film that a sensor fills: all of it, but for the sensors of a batch. In pixels from the
/// film's top left corner.
struct FilmPart {
  float left = 0, width = 1, height = 1;
  Vec2 lower, upper;  ///< of the places where rays start: the crop and, with sample_border, its border

  static FilmPart of(const Film& film, int index, int count);
  float sample_area() const { return (upper.x - lower.x) * (upper.y - lower.y); }  ///< [pixels^2]
  bool samples(Vec2 p) const { return p.x >= lower.x && p.y >= lower.y && p.x <= upper.x && p.y <= upper.y; }
};

class Sensor : public Object {
public:
  static constexpr const char* kFamily = "a sensor";
  using Object::Object;

  /// The ray seen at `film_position` (pixels from the film's top left corner, not the crop's); `lens` chooses
  /// a point of the aperture.
  virtual SensorRay sample_ray(const PlacedSensor& at, Vec2 film_position, Vec2 lens) const = 0;
  /// Whether sample_ray looks at `lens`: two dimensions of the sampler.
  virtual bool uses_lens() const { return false; }
  /// Where on the film a point of the scene is seen, for light tracing; nothing where it is not seen, or by a
  /// sensor that light cannot be connected to.
  virtual std::optional<SensorConnection> sample_direct(const PlacedSensor& /*at*/, const Vec3& /*reference*/,
                                                        Vec2 /*lens*/) const {
    return {};
  }

  /// The response to a ray through `p` of direction `d` (away from the sensor, as in sample_ray), whether or
  /// not p lies between the clip planes. `seen` is where on the film it is seen, as given to sample_ray or found by
  /// sample_direct: a line may meet the surface that a meter sits on at several places, so that a meter answers only
  /// where this is given, and a batch then asks the sensor that this is of. Nothing if the ray is not seen, or if
  /// light cannot be connected to the sensor. Sensors with parallel rays ignore `d`.
  virtual std::optional<SensorResponse> eval(const PlacedSensor& /*at*/, const Vec3& /*p*/, const Vec3& /*d*/,
                                             std::optional<Vec2> /*seen*/) const {
    return {};
  }

  /// Where the rays of a place on the film begin, of a sensor that measures at points. Light of an emitter that no
  /// ray meets arrives there, too (`Integrator::estimate`). Nothing for others.
  virtual std::optional<Receiver> receiver(const PlacedSensor& /*at*/, Vec2 /*film*/) const { return {}; }

  /// Where the ray of light, whose direction has unit length, passes receivers; nothing where it does not. It
  /// finds light that nothing can be connected with: that from a mirror. Of a batch, those of its sensors.
  virtual std::optional<SensorCrossing> crossing(const PlacedSensor& /*at*/, const Ray& /*light*/) const {
    return {};
  }
  virtual bool counts_crossings() const { return false; }

  /// Throws Error where the sensor cannot measure on that surface, on which it sits.
  virtual void check_shape(const ShapeArea& area) const;
  /// Throws Error where it cannot fill that part of a batch's film instead of a film of its own.
  virtual void check_in_batch(const FilmPart& part) const;
  /// Fills the derived members of the record. Throws Error if the sensor cannot be used there.
  virtual void fit(PlacedSensor& /*at*/) const {}

  /// The medium that it is in, where the scene states one; null: the surfaces around it tell.
  const Medium* medium() const { return medium_.get(); }
  const Film& film() const { return *film_; }
  const Sampler& sampler() const { return *sampler_; }
  /// It measures one number, not a picture.
  bool is_meter() const { return measures_ == Measures::value; }

protected:
  enum class Measures { picture, value };
  /// Reads what every sensor has: film (default: hdrfilm), sampler (default: sobol), medium, srf and shutter times.
  /// The film of a meter has one pixel and no reconstruction filter, which would weight its samples by their
  /// place.
  void read_common(const Properties& properties, Measures measures = Measures::picture);

  /// The unit vector along v, the value of a parameter. Throws Error for zero.
  static Vec3 unit_direction(const Properties& properties, std::string_view name, const Vec3& v);

  const std::shared_ptr<Film>& shared_film() const { return film_; }

private:
  std::shared_ptr<Film> film_;
  std::shared_ptr<Sampler> sampler_;
  MediumPtr medium_;
  Measures measures_ = Measures::picture;
};

}  // namespace aureole
