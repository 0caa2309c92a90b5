// SPDX-License-Identifier: Apache-2.0
// Several sensors that share one film, side by side.
#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/sensor/sensor_shape.h"

namespace aureole {
namespace {

class BatchSensor final : public Sensor {
public:
  explicit BatchSensor(const Properties& p) : Sensor(p) {
    read_common(p, Measures::picture, std::nullopt);
    for (const auto& child : p.get_children<Object>("sensor")) add(child);
    const int count = int(members_.size()), width = film().width();
    for (const Member& member : members_) shared_film()->set_measured(member.sensor->film().measured_kind());
    if (count == 0) throw Error(p.where(), "a batch needs at least one sensor");
    if (width % count != 0)
      throw Error(p.where(), "the film's width of " + std::to_string(width) +
                                 " pixels must be a multiple of the number of sensors, " +
                                 std::to_string(count));
    for (int i = 0; i < count; ++i) {
      const Sensor& sensor = *members_[size_t(i)].sensor;
      for (int k = 0; k < i; ++k)
        if (members_[size_t(k)].sensor == members_[size_t(i)].sensor)
          throw Error(sensor.properties().where(), "this sensor is in the batch twice");
      uses_lens_ |= sensor.uses_lens();
      if (sensor.is_meter()) shared_film()->use_box_filter();
    }
    for (int i = 0; i < count; ++i)
      members_[size_t(i)].sensor->check_in_batch(FilmPart::of(film(), i, count));
    per_pixel_ = float(count) / float(width);
  }

  bool uses_lens() const override { return uses_lens_; }

  void fit(PlacedSensor& at) const override {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      PlacedSensor& member = at.members.emplace_back();
      member.sensor = members_[i].sensor.get(), member.area = members_[i].area;
      member.scene_center = at.scene_center, member.scene_radius = at.scene_radius;
      member.part = FilmPart::of(film(), int(i), int(members_.size()));
      member.sensor->fit(member);
    }
  }

  void check_in_batch(const FilmPart&) const override {
    throw Error(properties().where(), "a batch cannot be in another batch: list all sensors in one");
  }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    return at.members[part_at(film.x * per_pixel_)].sample_ray(film, lens);
  }

  /// Chooses one of the sensors at random; lens.x is then rescaled to choose the point of its aperture.
  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override {
    const float scaled = lens.x * float(members_.size());
    const std::size_t i = part_at(scaled);
    const float rest = std::min(scaled - float(i), 0x1.fffffep-1f);
    auto c = at.members[i].sample_direct(reference, {rest, lens.y});
    if (c) c->importance *= float(members_.size());
    return c;
  }

  std::optional<Receiver> receiver(const PlacedSensor& at, Vec2 film) const override {
    return at.members[part_at(film.x * per_pixel_)].receiver(film);
  }

  bool counts_crossings() const override {
    return std::any_of(members_.begin(), members_.end(),
                       [](const Member& m) { return m.sensor->counts_crossings(); });
  }

  /// Used if the film position is unknown: returns the response of the first sensor that records the ray.
  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2> seen) const override {
    const std::size_t first = seen ? part_at(seen->x * per_pixel_) : 0,
                      end = seen ? first + 1 : at.members.size();
    for (std::size_t i = first; i < end; ++i)
      if (auto response = at.members[i].eval(p, d, seen)) {
        response->pdf_position *= at.members[i].part.sample_area() / at.part.sample_area();
        return response;
      }
    return {};
  }

private:
  /// A sensor and, if it sits on a shape, the surface on which it measures.
  struct Member {
    std::shared_ptr<const Sensor> sensor;
    std::shared_ptr<const ShapeArea> area;
    std::shared_ptr<const SensorShape> shape;  ///< the shape that contains the surface
  };

  void add(const ObjectPtr& child) {
    if (auto sensor = std::dynamic_pointer_cast<const Sensor>(child)) {
      members_.push_back({std::move(sensor), nullptr, nullptr});
    } else if (auto shape = std::dynamic_pointer_cast<const SensorShape>(child)) {
      if (!shape->sensor())
        throw Error(shape->properties().where(), "a shape in a batch needs a sensor of its own");
      members_.push_back({shape->sensor(), shape->sensor_area(), std::move(shape)});
    } else {
      throw Error(child->properties().where(), "a batch holds sensors, and shapes with sensors");
    }
  }

  std::size_t part_at(float x) const { return std::size_t(std::clamp(int(x), 0, int(members_.size()) - 1)); }

  std::vector<Member> members_;
  bool uses_lens_ = false;
  float per_pixel_ = 1;
};

AUREOLE_PLUGIN(
    BatchSensor, "sensor", "batch",
    PluginDoc{
        "Renders several sensors at once, side by side in equal parts of one film. The film, sampler and "
        "response of the batch replace the ones of its sensors; fields of view refer to the parts.",
        "",
        {{"sensor", "sensor or shape", "", "required",
          "the sensors, whose number must divide the film's width; also shapes with an irradiancemeter, as a "
          "<ref> if they belong to the scene"}},
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
