// SPDX-License-Identifier: Apache-2.0
// The radiance that leaves a scene, or a region of it, in one direction.
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/sensor/sensor_shape.h"

namespace aureole {
namespace {

class DistantSensor final : public Sensor {
public:
  explicit DistantSensor(const Properties& p) : Sensor(p) {
    read_common(p, Measures::value);
    const Transform to_world = p.get_transform("to_world");
    direction_ = p.get_vec3("direction", to_world.vector({0, 0, 1}));
    if (p.has("direction") && p.has("to_world"))
      throw p.error("direction", "give either \"direction\" or \"to_world\"");
    direction_ = unit_direction(p, "direction", direction_);
    if (p.get_bool("flip_directions", false)) direction_ = -direction_;
    offset_ = float(p.get_float("ray_offset", -1, Range::positive()));

    const Properties::Entry* target = p.find("target");
    if (!target) return;
    if (std::holds_alternative<Vec3>(target->value)) {
      target_ = Target::point;
      point_ = p.get_vec3("target", {});
    } else {
      if (!std::holds_alternative<ObjectPtr>(target->value))
        throw p.error("target", "expected a point or a shape");
      target_ = Target::shape;
      element_ = p.get_object<SensorShape>("target");
      if (const ShapePtr shape = element_->shape())
        surface_ = std::make_unique<const ShapeArea>(shape->make_area_sampler(AreaUse::sensor));
      if (!surface_ || !(surface_->area() > 0)) throw p.error("target", "the shape has no area");
    }
  }

  void fit(PlacedSensor& at) const override {
    at.scene_radius *= 1 + 1e-5f;  // the factor includes objects that touch the sphere
  }

  bool uses_lens() const override { return target_ != Target::point; }

  SensorRay sample_ray(const PlacedSensor& placed, Vec2, Vec2 lens) const override {
    Vec3 at = point_;
    if (target_ == Target::shape) {
      const auto s = surface_->sample(lens);
      if (!s) return {{}, 0};
      at = s->p;
    } else if (target_ == Target::scene) {
      const Vec2 disc = square_to_disc_concentric(lens).p;
      at = placed.scene_center +
           Frame::from_normal(direction_).to_world({disc.x, disc.y, 0}) * placed.scene_radius;
    }
    return {{start(placed, at), direction_, kInfinity}};
  }

  /// Connects a point without a target only: rays through a target form a line, or start at a shape, and
  /// light cannot be connected to them.
  std::optional<SensorConnection> sample_direct(const PlacedSensor& placed, const Vec3& reference,
                                                Vec2) const override {
    if (target_ != Target::scene) return {};
    const Vec3 from_center = reference - placed.scene_center;
    const Vec3 across = from_center - direction_ * dot(from_center, direction_);
    const float radius = placed.scene_radius;
    if (length_squared(across) > radius * radius) return {};
    const Vec3 p = start(placed, reference);
    if (dot(reference - p, direction_) < 0) return {};
    const Vec2 middle{placed.part.left + 0.5f, 0.5f};
    return SensorConnection{-direction_, p, middle, 1 / (kPi * radius * radius)};
  }

  std::optional<SensorResponse> eval(const PlacedSensor& placed, const Vec3& p, const Vec3&,
                                     std::optional<Vec2>) const override {
    const Vec3 from_center = p - placed.scene_center;
    const Vec3 across = from_center - direction_ * dot(from_center, direction_);
    const float radius = placed.scene_radius;
    if (target_ != Target::scene || length_squared(across) > radius * radius) return {};
    SensorResponse response;
    response.film = {placed.part.left + 0.5f, 0.5f};
    response.pdf_position = response.pdf_across = 1 / (kPi * radius * radius);
    response.pdf_direction = 1;
    return response;
  }

private:
  enum class Target { scene, point, shape };

  /// Origin of the ray through `at`: a point on the plane that touches the scene's bounding sphere, so that
  /// the whole scene lies ahead, or `ray_offset` before the target.
  Vec3 start(const PlacedSensor& placed, const Vec3& at) const {
    const float along = dot(at - placed.scene_center, direction_);
    if (offset_ < 0) return at - direction_ * std::max(along + placed.scene_radius, 0.f);
    return at - direction_ * (target_ == Target::scene ? along + offset_ : offset_);
  }

  Target target_ = Target::scene;
  Vec3 direction_, point_;
  std::shared_ptr<const SensorShape> element_;  ///< the shape that contains the target's surface
  std::unique_ptr<const ShapeArea> surface_;
  float offset_ = -1;  ///< distance of the origin before the target; negative: rays start outside the scene
};

AUREOLE_PLUGIN(
    DistantSensor, "sensor", "distant",
    PluginDoc{
        "Measures the radiance that leaves the scene in one direction, as from infinity, averaged over "
        "the cross section of the scene's bounding sphere, or over a target. A ray that hits nothing "
        "measures the environment. Its film has one pixel.",
        "",
        {{"direction", "vector", "", "to_world's z axis", "viewing direction of the sensor"},
         {"to_world", "transform", "", "identity",
          "instead of direction: the viewing direction is its z axis"},
         {"target", "point or shape", "scene units", "the scene",
          "a point through which all rays pass, or a shape through which they pass at uniformly distributed "
          "points; the shape itself is not part of the scene"},
         {"ray_offset", "float", "scene units", "from outside the scene",
          "distance of the ray origins before the target (without a target: before the centre of the scene)"},
         {"flip_directions", "boolean", "", "false", "reverses the viewing direction"}},
        {R"(<sensor type="distant">
    <vector name="direction" x="0" y="-1" z="0.3"/>
    <shape name="target" type="rectangle"/>
    <float name="ray_offset" value="10"/>
    <boolean name="flip_directions" value="false"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
    <sampler type="sobol"/>
</sensor>)",
         R"(<sensor type="distant">
    <transform name="to_world"><rotate x="1" angle="90"/></transform>
    <point name="target" x="0" y="0" z="0"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
