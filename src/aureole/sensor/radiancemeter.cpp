// SPDX-License-Identifier: Apache-2.0
// The radiance along one ray.
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {
namespace {

class RadianceMeter final : public Sensor {
public:
  explicit RadianceMeter(const Properties& p) : Sensor(p) {
    read_common(p, Measures::value);
    const Transform to_world = p.get_transform("to_world");
    const Vec3 origin = p.get_vec3("origin", {}), direction = p.get_vec3("direction", {0, 0, 1});
    if (p.has("origin") != p.has("direction"))
      throw p.error(p.has("origin") ? "origin" : "direction", "give both \"origin\" and \"direction\"");
    ray_ = {origin, unit_direction(p, "direction", direction), kInfinity};
    if (!p.has("to_world")) return;
    if (p.has("origin")) p.note("origin", "\"to_world\" is given, too, and is used instead");
    ray_ = {to_world.point({0, 0, 0}), unit_direction(p, "to_world", to_world.vector({0, 0, 1})), kInfinity};
  }

  SensorRay sample_ray(const PlacedSensor&, Vec2, Vec2) const override { return {ray_}; }

private:
  Ray ray_;
};

AUREOLE_PLUGIN(
    RadianceMeter, "sensor", "radiancemeter",
    PluginDoc{
        "Measures the radiance along one ray: a camera whose field of view is zero. Its film has one "
        "pixel.",
        "",
        {{"to_world", "transform", "", "identity", "the ray has its origin and the direction of its z axis"},
         {"origin", "point", "scene units", "0, 0, 0",
          "instead of to_world, together with direction: origin of the ray"},
         {"direction", "vector", "", "0, 0, 1", "direction of the ray"}},
        {R"(<sensor type="radiancemeter">
    <point name="origin" x="0" y="2" z="-5"/>
    <vector name="direction" x="0" y="-0.5" z="1"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
    <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
