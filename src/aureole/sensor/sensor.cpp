// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/texture/texture.h"

namespace aureole {

namespace {

/// Returns the only child of family T, or the family's default plug-in with `parameters`.
template <class T>
std::shared_ptr<T> child_or_default(const Properties& p, const char* family,
                                    const NamedValues& parameters = {}) {
  auto found = p.get_children<T>(family);
  if (found.size() > 1) throw Error(p.where(), std::string("a sensor has one ") + family);
  return found.empty() ? make_default<T>(p, family, parameters) : found.front();
}

std::string size_text(double width, double height) {
  return std::to_string(int(width)) + " x " + std::to_string(int(height));
}

}  // namespace

FilmPart FilmPart::of(const Film& film, int index, int count) {
  const float width = float(film.width() / count), left = width * float(index);
  const float border = film.sample_border() ? float(FilterTable(film.filter()).border()) : 0.f;
  FilmPart part{left, width, float(film.height()), {}, {}};
  part.lower = {float(film.crop_x()) - border, float(film.crop_y()) - border};
  part.upper = {float(film.crop_x() + film.crop_width()) + border,
                float(film.crop_y() + film.crop_height()) + border};
  if (index > 0) part.lower.x = std::max(part.lower.x, left);
  if (index + 1 < count) part.upper.x = std::min(part.upper.x, left + width);
  return part;
}

void Sensor::read_common(const Properties& p, Measures measures, std::optional<MeasuredKind> kind) {
  measures_ = measures;
  film_ = child_or_default<Film>(
      p, "film",
      is_meter() ? NamedValues{{"width", std::int64_t(1)}, {"height", std::int64_t(1)}} : NamedValues{});
  sampler_ = child_or_default<Sampler>(p, "sampler");
  medium_ = only_medium(p);
  if (is_meter()) {
    if (film_->width() != 1 || film_->height() != 1)
      throw Error(p.where(), "a sensor of type \"" + p.type() +
                                 "\" measures one value: its film has 1 x 1 pixels, not " +
                                 size_text(film_->width(), film_->height()));
    film_->use_box_filter();
  }
  if (const TexturePtr srf = get_optional_texture(p, "srf", SpectrumRole::response)) {
    if (!srf->is_constant()) throw p.error("srf", "a response is one spectrum, not a picture");
    film_->multiply_response(srf->average());
    if (!(film_->response().maximum() > 0))
      throw p.error("srf", "the sensor sees nothing: this is zero wherever the film responds");
  }
  if (kind) film_->set_measured(*kind);
  const bool opens = p.find("shutter_open"), closes = p.find("shutter_close");
  if (opens || closes) p.note("shutter_open", "nothing moves: the shutter times have no effect");
}

Vec3 Sensor::unit_direction(const Properties& p, std::string_view name, const Vec3& v) {
  const float largest = max_component(abs(v));
  if (!(largest > 0)) throw p.error(name, "must not be zero");
  // v is scaled first, since the squares of very large and very small components exceed the range of float
  return normalize(v * (1 / std::max(largest, 1e-37f)));
}

void Sensor::check_shape(const ShapeArea&) const {
  throw Error(properties().where(), "a sensor of type \"" + properties().type() +
                                        "\" cannot sit on a shape; \"irradiancemeter\" and \"powermap\" can");
}

void Sensor::check_in_batch(const FilmPart& part) const {
  if (properties().has("srf"))
    throw properties().error("srf", "all sensors of a batch have one response: give \"srf\" to the batch");
  for (const Properties::Entry& e : properties().entries())
    if (const auto* object = std::get_if<ObjectPtr>(&e.value); object && !is_meter())
      if (const auto own = std::dynamic_pointer_cast<Film>(*object))
        own->properties().note("", "all sensors of a batch are on its film: this one has no effect");
  if (is_meter() && (part.width != 1 || part.height != 1))
    throw Error(properties().where(), "a sensor of type \"" + properties().type() +
                                          "\" measures one value, but its part of the batch's film has " +
                                          size_text(part.width, part.height) + " pixels");
}

PlacedSensor PlacedSensor::of(const Sensor& sensor, std::shared_ptr<const ShapeArea> area,
                              const Vec3& scene_center, float scene_radius) {
  PlacedSensor at;
  at.sensor = &sensor, at.area = std::move(area);
  at.scene_center = scene_center, at.scene_radius = scene_radius;
  at.part = FilmPart::of(sensor.film(), 0, 1);
  sensor.fit(at);
  return at;
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "sensor",
    .parameters = {{"film", "film", "", "hdrfilm", "the measured quantity and its storage"},
                   {"sampler", "sampler", "", "sobol", "sample points"},
                   {"medium", "medium", "", "the medium inside the surfaces around it",
                    "medium around the sensor; needed only if no surface bounds that medium"},
                   {"srf", "spectrum", "", "1", "spectral response that multiplies the film's"},
                   {"shutter_open", "float", "s", "0", "accepted without effect"},
                   {"shutter_close", "float", "s", "0", "accepted without effect"}},
    .belongs_to_shapes = true,
    .is_reusable = true});

}  // namespace aureole
