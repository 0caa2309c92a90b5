// SPDX-License-Identifier: Apache-2.0
// The irradiance on a shape, averaged over its surface.
#include <algorithm>
#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/shape/shape_area.h"

namespace aureole {
namespace {

class IrradianceMeter final : public Sensor {
public:
  explicit IrradianceMeter(const Properties& p) : Sensor(p) {
    read_common(p, Measures::value, MeasuredKind::irradiance);
  }

  void check_shape(const ShapeArea& area) const override {
    if (!(area.area() > 0))
      throw Error(properties().where(), "the shape that the irradiance meter sits on has no area");
  }

  void fit(PlacedSensor& at) const override {
    if (!at.area)
      throw Error(properties().where(),
                  "an irradiance meter is a child of the shape whose irradiance it measures");
  }

  bool uses_lens() const override { return true; }

  /// Receiver at the point of the surface that the position within the pixel encodes.
  std::optional<Receiver> receiver(const PlacedSensor& at, Vec2 film) const override {
    return receiver_at(at, {film.x - std::floor(film.x), film.y - std::floor(film.y)});
  }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    const auto place = receiver(at, film);
    return place ? place->sample_ray(lens) : SensorRay{{}, 0};
  }

  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override {
    // The film position, which encodes the point of the surface within the pixel; it must not round up to the
    // next pixel.
    const Vec2 film{std::min(at.part.left + lens.x, std::nextafter(at.part.left + 1, 0.f)), lens.y};
    const auto place = receiver(at, film);
    if (!place) return {};
    return place->connect(reference, film, 1);
  }

  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2> seen) const override {
    if (!seen) return {};
    const auto place = receiver(at, *seen);
    if (!place) return {};
    const Vec3 to = p - place->p;
    const float distance2 = length_squared(to);
    SensorResponse response;
    response.pdf_direction = place->pdf(d);
    if (!(distance2 > 0 && dot(to, d) > 0 && response.pdf_direction > 0)) return {};
    response.film = *seen;
    response.weight = place->total();
    response.pdf_position = measured_area(at) / (float(at.area->area()) * place->weight);
    response.pdf_across = response.pdf_direction / distance2;
    return response;
  }

private:
  std::optional<Receiver> receiver_at(const PlacedSensor& at, Vec2 u) const {
    const auto s = at.area->sample(u);
    if (!s) return {};
    return Receiver{s->p, s->p_error, s->ng, Receiver::Measure::irradiance,
                    even_weight(at, s->pdf) * measured_area(at)};
  }
  /// The weight for an even response over the surface, to points of that pdf.
  static float even_weight(const PlacedSensor& at, float pdf) { return float(1 / at.area->area()) / pdf; }
  /// Area by which the irradiance is multiplied [m^2]: that of the surface where the film measures power, else 1.
  float measured_area(const PlacedSensor& at) const {
    const double unit = properties().context().length_unit_m;
    return film().measures_flux() ? float(at.area->area() * unit * unit) : 1;
  }
};

AUREOLE_PLUGIN(
    IrradianceMeter, "sensor", "irradiancemeter",
    PluginDoc{
        .summary =
            "Measures the irradiance [W/(m^2 nm) for a spectral film] on the shape that it is a child of, "
            "from the side of its normal, averaged over its surface; or, with a quantity of the film such as luminous_flux, the "
            "power through it. Its film has one pixel; a "
            "reconstruction filter other than `box` would weight the surface and is replaced.",
        .source = "",
        .parameters = {},
        .examples = {R"(<sensor type="irradiancemeter">
    <film type="hdrfilm">
        <integer name="width" value="1"/> <integer name="height" value="1"/> <rfilter type="box"/>
    </film>
    <sampler type="sobol"/>
</sensor>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole
