// SPDX-License-Identifier: Apache-2.0
// Several sensors side by side on one film.
#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "aureole/sensor/sensor_docs.h"
#include "aureole/shape/shape.h"

namespace aureole {
namespace {

class BatchSensor final : public Sensor {
public:
  explicit BatchSensor(const Properties& p) : Sensor(p) {
    read_common(p);
    for (const auto& child : p.get_children<Object>("sensor")) add(child);
    const int count = int(sensors_.size()), width = film().width();
    if (count == 0) throw Error(p.where(), "a batch needs at least one sensor");
    if (width % count != 0)
      throw Error(p.where(), "the film's width of " + std::to_string(width) +
                                 " pixels must be a multiple of the number of sensors, " +
                                 std::to_string(count));
    for (int i = 0; i < count; ++i) {
      const Sensor& sensor = *sensors_[size_t(i)];
      if (std::find(sensors_.begin(), sensors_.begin() + i, sensors_[size_t(i)]) != sensors_.begin() + i)
        throw Error(sensor.properties().where(), "this sensor is in the batch twice");
      uses_lens_ |= sensor.uses_lens();
      if (sensor.is_meter()) shared_film()->use_box_filter();
    }
    for (int i = 0; i < count; ++i) sensors_[size_t(i)]->share_film(shared_film(), i, count);
    per_pixel_ = float(count) / float(width);
  }

  bool uses_lens() const override { return uses_lens_; }

  void set_scene_bounds(const Vec3& center, float radius) override {
    for (const auto& sensor : sensors_) sensor->set_scene_bounds(center, radius);
  }

  void share_film(const std::shared_ptr<Film>&, int, int) override {
    throw Error(properties().where(), "a batch cannot be in another batch: list all sensors in one");
  }

  SensorRay sample_ray(Vec2 film, Vec2 lens) const override {
    return sensors_[part_at(film.x * per_pixel_)]->sample_ray(film, lens);
  }

  /// One of the sensors, by chance; what is left of lens.x chooses its point.
  std::optional<SensorConnection> sample_direct(const Vec3& reference, Vec2 lens) const override {
    const float scaled = lens.x * float(sensors_.size());
    const std::size_t i = part_at(scaled);
    const float rest = std::min(scaled - float(i), 0x1.fffffep-1f);
    auto c = sensors_[i]->sample_direct(reference, {rest, lens.y});
    if (c) c->importance *= float(sensors_.size());
    return c;
  }

private:
  void add(const ObjectPtr& child) {
    if (auto sensor = std::dynamic_pointer_cast<Sensor>(child)) {
      sensors_.push_back(std::move(sensor));
    } else if (auto shape = std::dynamic_pointer_cast<Shape>(child)) {
      if (!shape->sensor())
        throw Error(shape->properties().where(), "a shape in a batch needs a sensor of its own");
      shape->sensor()->attach(*shape);
      sensors_.push_back(shape->sensor());
      shapes_.push_back(std::move(shape));
    } else {
      throw Error(child->properties().where(), "a batch holds sensors, and shapes with sensors");
    }
  }

  std::size_t part_at(float x) const { return std::size_t(std::clamp(int(x), 0, int(sensors_.size()) - 1)); }

  std::vector<std::shared_ptr<Shape>> shapes_;
  std::vector<std::shared_ptr<Sensor>> sensors_;
  bool uses_lens_ = false;
  float per_pixel_ = 1;
};

AUREOLE_PLUGIN(
    BatchSensor, "sensor", "batch",
    PluginDoc{
        "Renders several sensors at once, side by side in equal parts of one film. The film, sampler and "
        "response of the batch are used, those of its "
        "sensors are not; fields of view refer to the parts.",
        "",
        sensor_parameters(
            {{"sensor", "sensor or shape", "", "required",
              "as many as divide the film's width; shapes with an irradiancemeter, as a <ref> where they "
              "are parts of the scene"}}),
        {R"(<sensor type="batch">
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    </sensor>
    <sensor type="orthographic">
        <transform name="to_world"><lookat origin="5, 0, 0" target="0, 0, 0" up="0, 1, 0"/></transform>
    </sensor>
    <film type="hdrfilm"><integer name="width" value="512"/><integer name="height" value="256"/></film>
    <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
