// SPDX-License-Identifier: Apache-2.0
// A camera that sees all directions: a panorama in latitude-longitude projection.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/math/lat_long.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

class SphericalSensor final : public Sensor {
public:
  explicit SphericalSensor(const Properties& p) : Sensor(p), clip_(p) {
    read_common(p);
    to_world_ = rigid_transform(p, read_motion(p));
    to_camera_ = to_world_.inverse();
    origin_ = to_world_.point({0, 0, 0});
    if (film().sample_border())
      throw p.error(
          "film",
          "\"sample_border\" is not for a spherical camera, whose picture has no border: leave it out");
    if (film().width() != 2 * film().height())
      p.note("film", "the picture is not twice as wide as high: its pixels are stretched");
  }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2) const override {
    // Beyond the poles, where a border of the film is sampled, rays of the picture's last row are used.
    const Vec2 uv{(film.x - at.part.left) / at.part.width, std::clamp(film.y / at.part.height, 0.f, 1.f)};
    const Vec3 d = normalize(to_world_.vector(lat_long_direction(uv)));
    return {{origin_ + d * clip_.near, d, clip_.far - clip_.near}};
  }

  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2) const override {
    const Vec3 q = to_camera_.point(reference);
    const float distance = length(q);
    if (!(distance >= clip_.near && distance <= clip_.far)) return {};
    const Vec3 d = q * (1 / distance), toward = normalize(to_world_.vector(d));
    const Vec2 film = film_of(at, d);
    if (!at.part.samples(film)) return {};
    return SensorConnection{-toward, origin_ + toward * clip_.near, film,
                            pixels_per_angle(at, d) / (distance * distance)};
  }

  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& direction,
                                     std::optional<Vec2>) const override {
    const Vec3 q = to_camera_.point(p), d = normalize(to_camera_.vector(direction));
    // Whether the ray comes from the origin, to within the rounding error of the coordinates.
    const float distance = dot(q, d), rounding = 1e-5f * (length(origin_) + length(q));
    if (!(distance > 0) || length(q - d * distance) > rounding) return {};
    SensorResponse response;
    response.film = film_of(at, d);
    if (!at.part.samples(response.film)) return {};
    response.pdf_position = 1;
    response.pdf_direction = pixels_per_angle(at, d) / at.part.sample_area();
    response.pdf_across = response.pdf_direction / (distance * distance);
    return response;
  }

  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    bool all_near = true;
    float nearest = kInfinity, farthest = 0;
    for (const Bounds3& box : shapes) {
      const Vec3 a = box.lower - origin_, b = origin_ - box.upper;
      Vec3 gap, reach;
      for (int i = 0; i < 3; ++i)
        gap[i] = std::max({a[i], b[i], 0.f}), reach[i] = std::max(std::abs(a[i]), std::abs(b[i]));
      const float from = length(gap), to = length(reach);
      if (from <= clip_.far && to >= clip_.near) return {};
      all_near &= to < clip_.near;
      nearest = std::min(nearest, from), farthest = std::max(farthest, to);
    }
    if (shapes.empty()) return {};
    return properties()
        .error(all_near ? "near_clip" : "far_clip",
               fmt::format("every shape lies nearer than near_clip, {:g}, or beyond far_clip, {:g}, so that "
                           "the camera sees none: their distances are {:.4g} to {:.4g}",
                           clip_.near, clip_.far, nearest, farthest))
        .what();
  }

private:
  static Vec2 film_of(const PlacedSensor& at, const Vec3& d) {
    const Vec2 uv = lat_long_uv(d);
    return {at.part.left + uv.x * at.part.width, uv.y * at.part.height};
  }
  /// Area of film [pixels^2] per solid angle. The area is infinite at the poles, so that the sine has a lower
  /// bound.
  static float pixels_per_angle(const PlacedSensor& at, const Vec3& d) {
    const float sine = std::max(std::hypot(d.x, d.z), 1e-6f);
    return at.part.width * at.part.height / (2 * kPi * kPi * sine);
  }

  Transform to_world_, to_camera_;
  ClipPlanes clip_;
  Vec3 origin_;
};

AUREOLE_PLUGIN(
    SphericalSensor, "sensor", "spherical",
    PluginDoc{
        "Camera that sees all directions: a panorama in latitude-longitude projection, twice as wide as high. Its "
        "middle looks along the camera's +z axis and its upper edge along +y. The picture is an environment map: "
        "`envmap` with the same `to_world` shows what the camera saw. `near_clip` and `far_clip` are distances along "
        "the rays.",
        "",
        camera_parameters(
            {{"to_world", "transform", "", "identity",
              "camera to world; must not scale. An `<animation>` of key frames moves the camera"}}),
        {R"(<sensor type="spherical">
    <transform name="to_world"><lookat origin="0, 1.6, 0" target="0, 1.6, 1" up="0, 1, 0"/></transform>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <film type="hdrfilm"><integer name="width" value="512"/><integer name="height" value="256"/></film>
    <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
