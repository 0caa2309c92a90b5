// SPDX-License-Identifier: Apache-2.0
// The sensor family: a sensor maps points of the film to rays. It is a model of the measurement; scene and
// film data are in a `PlacedSensor` (placed_sensor.h), which is passed to its methods.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "aureole/film/film.h"
#include "aureole/math/transform.h"
#include "aureole/medium/medium.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"

namespace aureole {

class ShapeArea;
struct PlacedSensor;

/// When a sensor measures. Every point of the film is exposed from `open` to `close`; where the sensor reads its rows or
/// columns one after the other, the exposure of the last one begins `readout` later (rolling shutter).
struct Exposure {
  enum class Readout { down, up, right, left };
  double open = 0, close = 0;  ///< [s]
  double readout = 0;          ///< [s]
  Readout direction = Readout::down;

  double duration() const { return close - open; }
  bool is_instant() const { return close == open; }
  /// When the exposure of a pixel of a film of that size begins [s].
  double begin(int x, int y, int width, int height) const;
  /// The time at the fraction `u` of the exposure of a pixel of a film of that size.
  float time(float u, int x, int y, int width, int height) const {
    return float(begin(x, y, width, height) + double(u) * duration());
  }
};

struct SensorRay {
  Ray ray;
  float weight = 1;  ///< factor of the radiance along the ray
};

/// A connection from a point of the scene to a point of the aperture.
struct SensorConnection {
  Vec3 wo;    ///< unit direction from the reference point towards the aperture
  Vec3 p;     ///< origin of the ray of Sensor::sample_ray; the segment up to here must be unoccluded
  Vec2 film;  ///< film position of the light, as in Sensor::sample_ray
  /// Area of film [pixels^2] per area perpendicular to `wo` at the reference point [1/m^2], over the pdf of
  /// p. Radiance leaving the reference point, times |cos| there, times importance is the contribution to the
  /// film per area [m^2] of surface.
  float importance = 0;
};

/// The response of a sensor to a given ray: the inverse of Sensor::sample_ray.
struct SensorResponse {
  Vec2 film;         ///< film position of the ray
  float weight = 1;  ///< factor of the radiance along the ray
  // Pdfs with which sample_ray samples the ray, for uniform positions on the sensor's part of the film and on
  // the lens.
  float pdf_position = 0;   ///< pdf of the point of the aperture [1/m^2], or a probability mass for a single
                            ///< point
  float pdf_direction = 0;  ///< pdf of the direction [1/sr], or a probability mass for a single direction
  /// Pdf with which rays cross the given point, per area perpendicular to the ray [1/m^2]: rays from that
  /// point of the aperture, or rays of the single direction.
  float pdf_across = 0;
};

/// A point at which a sensor measures light arriving from all directions or from a half-space.
struct Receiver {
  /// How the response depends on the direction.
  enum class Measure {
    irradiance,   ///< the cosine with the normal, on its side
    fluence,      ///< 1
    cylindrical,  ///< sin(e)/pi with e the angle from `axis`: the mean over the side of a small cylinder
    /// sin(e) (1 + cos(a))/pi with a the azimuth from the normal about `axis`: the mean over half of that
    /// side
    semicylindrical,
    far  ///< 1 for emitters without extent, seen by the receiver from afar; it samples no ray
  };

  Vec3 p;
  Vec3 p_error;  ///< bound of the rounding error of p; zero for a point that lies on no surface
  Vec3 ng;       ///< unit normal
  Measure measure = Measure::fluence;
  float weight = 1;  ///< factor of the response, to correct the pdf of the receiver's position
  Vec3 axis{};       ///< unit axis of a cylinder; a semicylinder's normal is perpendicular to it
  /// for Measure::far, the pdf [1/sr] of a ray of the sensor at its own position (see the sensors)
  float far_share = 0;

  /// Returns the factor of the radiance that arrives from the unit direction `d`.
  float response(const Vec3& d) const;
  /// Returns the integral of the response over all directions.
  float total() const;
  /// The pdf of `sample_ray` [1/sr]: the response over its integral, without `weight`.
  float pdf(const Vec3& d) const;
  /// The normal of the half-space that is measured, or zero for all directions.
  Vec3 facing() const { return measure == Measure::irradiance ? ng : Vec3{}; }

  /// Samples a ray in proportion to the response; the weight of the ray is `total`.
  SensorRay sample_ray(Vec2 u) const;
  /// As `Sensor::sample_direct` for the receiver at `film`, sampled uniformly from `film_area` [pixels^2].
  /// Returns nothing if the receiver does not measure light from `reference`.
  std::optional<SensorConnection> connect(const Vec3& reference, Vec2 film, float film_area) const;
};

/// An intersection of a ray of light with the receivers of a sensor.
struct SensorCrossing {
  Vec3 p;
  Vec2 film;  ///< film position, as in Sensor::sample_ray
  /// Area of film [pixels^2] per area of the receivers' plane [1/m^2] times response over |cos|. The power of
  /// the ray times importance is the contribution to the film.
  float importance;
};

/// The part of a film that a sensor fills, in pixels from the film's top left corner: the whole film, except
/// for the sensors of a batch.
struct FilmPart {
  float left = 0, width = 1, height = 1;
  Vec2 lower, upper;  ///< bounds of the ray positions: the crop and, with sample_border, its border

  static FilmPart of(const Film& film, int index, int count);
  /// area of the ray positions on the film [pixels^2]
  float sample_area() const { return (upper.x - lower.x) * (upper.y - lower.y); }
  bool samples(Vec2 p) const { return p.x >= lower.x && p.y >= lower.y && p.x <= upper.x && p.y <= upper.y; }
};

/// A projection through one point, as a camera of computer vision states it: x to the right and y down in the picture, z
/// along the optical axis.
struct PinholeView {
  Transform to_camera;              ///< transform from the world to camera space
  Vec2 center;                      ///< film position of the optical axis [pixels]
  float focal = 1;                  ///< focal length [pixels]: film = center + focal (x / z, y / z)
  float near = 0, far = kInfinity;  ///< depths z between which geometry is visible
};

class Sensor : public Object {
public:
  static constexpr const char* kFamily = "a sensor";
  using Object::Object;

  /// Samples the ray of `film_position` (pixels from the film's top left corner, not the crop's). `lens`
  /// chooses a point of the aperture.
  virtual SensorRay sample_ray(const PlacedSensor& at, Vec2 film_position, Vec2 lens) const = 0;
  /// Whether rays depend on the wavelength: paths then have one, `Wavelengths::of_hero`, and `sample_dispersed_ray` makes
  /// their rays.
  virtual bool disperses() const { return false; }
  /// As `sample_ray`, at a wavelength [nm].
  virtual SensorRay sample_dispersed_ray(const PlacedSensor& at, Vec2 film_position, Vec2 lens,
                                         float /*nm*/) const {
    return sample_ray(at, film_position, lens);
  }
  /// Whether sample_ray uses `lens`: two dimensions of the sampler.
  virtual bool uses_lens() const { return false; }
  /// Connects a point of the scene to the sensor, for light tracing. Returns nothing if the point is not
  /// visible on the film, or if light cannot be connected to this sensor.
  virtual std::optional<SensorConnection> sample_direct(const PlacedSensor& /*at*/, const Vec3& /*reference*/,
                                                        Vec2 /*lens*/) const {
    return {};
  }

  /// Returns the response to a ray through `p` of direction `d` (away from the sensor, as in sample_ray),
  /// whether or not p is between the clip planes. `seen` is its film position if known, as given to
  /// sample_ray or found by sample_direct. Meters need it, because a line may intersect their surface more
  /// than once; a batch uses it to select the sensor. Returns nothing if the ray does not reach the film, or
  /// if light cannot be connected to the sensor. Sensors with parallel rays ignore `d`.
  virtual std::optional<SensorResponse> eval(const PlacedSensor& /*at*/, const Vec3& /*p*/, const Vec3& /*d*/,
                                             std::optional<Vec2> /*seen*/) const {
    return {};
  }

  /// For a sensor that measures at points: the origin of the rays of a film position. Light from delta
  /// emitters, which no ray hits, arrives there as well (`Integrator::estimate`). Nothing for other sensors.
  virtual std::optional<Receiver> receiver(const PlacedSensor& /*at*/, Vec2 /*film*/) const { return {}; }

  /// The intersection of a ray of light, of unit direction, with the receivers; nothing if it misses them. It
  /// finds light for which no connection is possible, such as light from a mirror. For a batch, see
  /// `PlacedSensor::for_crossings`.
  virtual std::optional<SensorCrossing> crossing(const PlacedSensor& /*at*/, const Ray& /*light*/) const {
    return {};
  }
  virtual bool counts_crossings() const { return false; }

  /// The projection of a camera without a lens; nothing for other sensors.
  virtual std::optional<PinholeView> pinhole(const PlacedSensor& /*at*/) const { return {}; }

  /// Throws Error if the sensor cannot measure on the surface of its parent shape.
  virtual void check_shape(const ShapeArea& area) const;
  /// Throws Error if the sensor cannot fill that part of a batch's film instead of its own film.
  virtual void check_in_batch(const FilmPart& part) const;
  /// Returns a located note if the clip planes hide all of the shapes, given by their bounds, else an empty string.
  virtual std::string clipping_note(std::span<const Bounds3> /*shapes*/) const { return {}; }
  /// Fills the derived members of the record. Throws Error if the sensor cannot be used with them.
  virtual void fit(PlacedSensor& /*at*/) const {}

  const Exposure& exposure() const { return exposure_; }
  /// Where the sensor is over time; null: it stands still. All other functions hold for its place at `motion()->first()`,
  /// and `PlacedSensor` moves what they take and give.
  const Motion* motion() const { return motion_.is_moving() ? &motion_ : nullptr; }

  /// The medium around the sensor, if the scene states one; null: it follows from the surfaces around it.
  const Medium* medium() const { return medium_.get(); }
  const Film& film() const { return *film_; }
  const Sampler& sampler() const { return *sampler_; }
  /// Whether the sensor measures one number instead of a picture.
  bool is_meter() const { return measures_ == Measures::value; }

protected:
  enum class Measures { picture, value };
  /// Reads the parameters of every sensor: film (default: hdrfilm), sampler (default: sobol), medium, srf and
  /// shutter times. A meter's film must have one pixel and no reconstruction filter, which would weight
  /// samples by their position in the pixel.
  /// `kind` is the kind of quantity that the film measures; without it the sensor itself calls
  /// `Film::set_measured`.
  void read_common(const Properties& properties, Measures measures = Measures::picture,
                   std::optional<MeasuredKind> kind = MeasuredKind::radiance);

  /// Returns the unit vector along v, the value of the parameter `name`. Throws Error for a zero vector.
  static Vec3 unit_direction(const Properties& properties, std::string_view name, const Vec3& v);

  const std::shared_ptr<Film>& shared_film() const { return film_; }
  /// Reads the transform or the animation `to_world`, and returns the transform of its first key frame. Throws Error if
  /// it is an animation that scales, and for the sensors of a batch.
  Transform read_motion(const Properties& properties);

private:
  std::shared_ptr<Film> film_;
  std::shared_ptr<Sampler> sampler_;
  MediumPtr medium_;
  Exposure exposure_;
  Motion motion_;
  Measures measures_ = Measures::picture;
};

}  // namespace aureole
