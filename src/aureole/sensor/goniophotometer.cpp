// SPDX-License-Identifier: Apache-2.0
// A goniophotometer: the intensity by direction of the whole scene, which counts as one luminaire.
#include <algorithm>
#include <cmath>

#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {
namespace {

class Goniophotometer final : public Sensor {
public:
  explicit Goniophotometer(const Properties& p) : Sensor(p) {
    read_common(p, Measures::picture, MeasuredKind::intensity);
    shared_film()->use_box_filter("each pixel is a measured direction: a box is used");
    if (film().height() < 2)
      throw Error(p.where(), "a goniophotometer needs at least 2 rows, for 0 and 180 degrees");
    const Transform to_world = p.get_transform("to_world");
    const char* names[3] = {"x", "y", "z"};
    Vec3 axes[3];
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = to_world.vector({i == 0 ? 1.f : 0.f, i == 1 ? 1.f : 0.f, i == 2 ? 1.f : 0.f});
      axes[i] = unit_direction(p, "to_world", v);
      for (int k = 0; k < i; ++k)
        if (std::abs(dot(axes[i], axes[k])) > 1e-3f)
          throw p.error("to_world", std::string("the axes ") + names[k] + " and " + names[i] +
                                        " are not at a right angle: a goniophotometer must not be sheared");
    }
    axes_ = {axes[0], axes[1], axes[2]};
    const double unit = p.context().length_unit_m;
    area_unit_ = float(unit * unit);
  }

  bool uses_lens() const override { return true; }
  bool counts_crossings() const override { return true; }

  void check_in_batch(const FilmPart&) const override {
    throw Error(properties().where(), "a goniophotometer measures directions and cannot be in a batch");
  }

  void fit(PlacedSensor& at) const override {
    at.scene_radius *= 1 + 1e-5f;  // the factor includes objects that touch the sphere
  }

  /// A ray from outside the scene against the direction of the pixel, through a point of the disc that the bounding
  /// sphere covers. Its weight is the area of the disc, so that the mean is the integral of the radiance over it.
  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    const Vec3 d = direction(pixel_of(at, film));
    const Vec2 disc = square_to_disc_concentric(lens).p;
    const Vec3 o = at.scene_center + Frame::from_normal(d).to_world({disc.x, disc.y, 1}) * at.scene_radius;
    return {{o, -d, kInfinity}, disc_area(at) * area_unit_};
  }

  /// Receiver at a distance of kFarRadii radii of the scene, to which light sources without extent send their
  /// light.
  std::optional<Receiver> receiver(const PlacedSensor& at, Vec2 film) const override {
    const Vec3 d = direction(pixel_of(at, film));
    const float distance = kFarRadii * at.scene_radius;
    Receiver r;
    r.p = at.scene_center + d * distance;
    r.ng = -d;
    r.measure = Receiver::Measure::far;
    // The irradiance times the square of the distance is the intensity, and the estimate is multiplied by the weight
    // of `sample_ray`.
    r.far_share = distance * distance / disc_area(at);
    return r;
  }

  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override {
    const Vec2 lower = at.part.lower, size = at.part.upper - lower;
    const Vec2 film{lower.x + size.x * lens.x, lower.y + size.y * lens.y};
    const Vec2 pixel = pixel_of(at, film);
    const Vec3 d = direction(pixel), from_center = reference - at.scene_center;
    const float beyond = std::max(at.scene_radius - dot(from_center, d), 1e-3f * at.scene_radius);
    return SensorConnection{
        d, reference + d * beyond, {pixel.x + 0.5f, pixel.y + 0.5f}, at.part.sample_area() * area_unit_};
  }

  /// Light that leaves the scene, counted in the cell around its direction.
  std::optional<SensorCrossing> crossing(const PlacedSensor& at, const Ray& light) const override {
    const Vec3 local = axes_.to_local(light.d);
    const double polar = std::atan2(std::hypot(double(local.x), double(local.y)), double(local.z));
    double azimuth = std::atan2(-double(local.y), double(local.x)) / (2 * M_PI);
    azimuth -= std::floor(azimuth);
    const int width = film().width(), height = film().height();
    const int column = int(azimuth * width + 0.5) % width,
              row = std::min(int(polar / M_PI * (height - 1) + 0.5), height - 1);
    const Vec2 position{float(column) + 0.5f, float(row) + 0.5f};
    if (!at.part.samples(position)) return {};
    const double step = M_PI / (height - 1);
    const double low = std::max(0.0, (row - 0.5) * step), high = std::min(M_PI, (row + 0.5) * step);
    const double solid_angle = 2 * M_PI / width * (std::cos(low) - std::cos(high));
    const Vec3 to_center = at.scene_center - light.o;
    const float beyond =
        std::max(dot(to_center, light.d) + at.scene_radius * 1.001f, 1e-3f * at.scene_radius);
    return SensorCrossing{light.o + light.d * beyond, position, float(1 / solid_angle) * area_unit_};
  }

private:
  static constexpr float kFarRadii = 1000;

  float disc_area(const PlacedSensor& at) const { return kPi * at.scene_radius * at.scene_radius; }
  Vec2 pixel_of(const PlacedSensor& at, Vec2 film) const {
    return {std::clamp(std::floor(film.x), 0.f, at.part.width - 1),
            std::clamp(std::floor(film.y), 0.f, at.part.height - 1)};
  }
  /// The direction of a pixel: C = 360 degrees column / width, gamma = 180 degrees row / (height - 1).
  Vec3 direction(Vec2 pixel) const {
    const double gamma = M_PI * double(pixel.y) / (film().height() - 1),
                 c = 2 * M_PI * double(pixel.x) / film().width();
    return normalize(axes_.to_world({float(std::sin(gamma) * std::cos(c)),
                                     float(-std::sin(gamma) * std::sin(c)), float(std::cos(gamma))}));
  }

  Frame axes_;
  float area_unit_ = 1;  ///< square of the scene's unit of length [m^2]
};

AUREOLE_PLUGIN(
    Goniophotometer, "sensor", "goniophotometer",
    PluginDoc{
        "Measures the intensity of the scene, as one luminaire, by direction. The columns of its film are half-planes C = "
        "360 degrees column / width, its rows angles gamma = 180 degrees row / (height - 1) from the local +z axis. C = 0 "
        "is the local +x axis and C = 90 is -y: counter-clockwise as seen from above, with +z down, as in IES LM-63 and "
        "in `photometric`. Each pixel holds the intensity in its direction alone; light from mirrors and through smooth "
        "glass, which no connection finds, is averaged over the cell around it. The far field is meant: emitters without "
        "extent are seen from 1000 radii of the scene's bounding sphere, all other light in parallel. `ptracer` finds "
        "all light, `path` that of emitters with extent and of what they light. `aureole goniophotometer` writes IES and "
        "EULUMDAT files.",
        "CIE 121-1996, The photometry and goniophotometry of luminaires",
        {{"to_world", "transform", "", "identity",
          "luminaire to world: +z to the direction gamma = 0, x along the luminaire. Position and scale have no effect"}},
        {R"(<sensor type="goniophotometer">
    <transform name="to_world"><rotate x="1" angle="180"/></transform>
    <film type="hdrfilm">
        <integer name="width" value="24"/> <integer name="height" value="37"/>
        <string name="quantity" value="luminous_intensity"/> <rfilter type="box"/>
    </film>
    <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
