// SPDX-License-Identifier: Apache-2.0
// A camera with parallel projection.
#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

class OrthographicSensor final : public Sensor {
public:
  explicit OrthographicSensor(const Properties& p) : Sensor(p), clip_(p) {
    read_common(p);
    to_world_ = read_motion(p);
    to_camera_ = to_world_.inverse();
    const Vec3 axis = to_world_.vector({0, 0, 1});
    axis_length_ = length(axis);
    direction_ = normalize(axis);
    if (p.find("focus_distance"))
      p.note("focus_distance", "nothing is out of focus: \"focus_distance\" has no effect");
  }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2) const override {
    const Vec3 start{(at.film_center.x - film.x) * at.pixel_size, (at.film_center.y - film.y) * at.pixel_size,
                     clip_.near};
    return {{to_world_.point(start), direction_, clip_.far - clip_.near}};
  }

  void fit(PlacedSensor& at) const override {
    const float scale = at.pixel_size = 2 / at.part.width;
    at.film_center = {at.part.left + 0.5f * at.part.width, 0.5f * at.part.height};
    const Vec3 pixel_x = to_world_.vector({scale, 0, 0}), pixel_y = to_world_.vector({0, scale, 0});
    at.pixels_per_area = 1 / std::abs(dot(cross(pixel_x, pixel_y), direction_));
  }

  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    return clip_.note(properties(), to_camera_, shapes, clip_.near + (clip_.far - clip_.near) / axis_length_);
  }

  /// Connects a point of the scene. The ray direction is fixed, so that a point has one film position,
  /// whatever its distance.
  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2) const override {
    const Vec3 q = to_camera_.point(reference);
    const float distance = (q.z - clip_.near) * axis_length_;
    if (!(distance >= 0 && distance <= clip_.far - clip_.near)) return {};
    const Vec2 film{at.film_center.x - q.x / at.pixel_size, at.film_center.y - q.y / at.pixel_size};
    if (!at.part.samples(film)) return {};
    return SensorConnection{-direction_, to_world_.point({q.x, q.y, clip_.near}), film, at.pixels_per_area};
  }

  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3&,
                                     std::optional<Vec2>) const override {
    const Vec3 q = to_camera_.point(p);
    SensorResponse response;
    response.film = {at.film_center.x - q.x / at.pixel_size, at.film_center.y - q.y / at.pixel_size};
    if (!at.part.samples(response.film)) return {};
    response.pdf_position = at.pixels_per_area / at.part.sample_area();
    response.pdf_direction = 1;
    response.pdf_across = response.pdf_position;
    return response;
  }

private:
  Transform to_world_, to_camera_;
  ClipPlanes clip_;
  Vec3 direction_;
  float axis_length_ = 1;
};

AUREOLE_PLUGIN(
    OrthographicSensor, "sensor", "orthographic",
    PluginDoc{
        "Camera with parallel rays along its local +z axis. Its picture is the square [-1, 1]^2 of the "
        "plane z = 0 of the camera, cut or extended in height to the film's aspect; the scale of "
        "to_world makes it larger.",
        "",
        camera_parameters(
            {{"to_world", "transform", "", "identity",
              "camera to world; its x and y scale set the size of the visible area. An `<animation>` of key "
              "frames moves the camera"},
             {"focus_distance", "float", "scene units", "none", "accepted without effect"}}),
        {R"(<sensor type="orthographic">
    <transform name="to_world">
        <scale x="3" y="3"/>
        <lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/>
    </transform>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <film type="hdrfilm"/> <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
