// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

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

Exposure read_exposure(const Properties& p) {
  constexpr double kLongest = 1e9;
  Exposure e;
  e.open = p.get_float("shutter_open", 0, {-kLongest, kLongest});
  e.close = p.get_float("shutter_close", e.open, {-kLongest, kLongest});
  if (e.close < e.open) throw p.error("shutter_close", "must not be before shutter_open");
  e.readout = p.get_float("readout_time", 0, {0, kLongest});
  using Readout = Exposure::Readout;
  const std::string direction = p.get_choice("readout_direction", "down", {"down", "up", "right", "left"});
  e.direction = direction == "up"      ? Readout::up
                : direction == "right" ? Readout::right
                : direction == "left"  ? Readout::left
                                       : Readout::down;
  if (p.has("readout_direction") && !(e.readout > 0))
    p.note("readout_direction", "has no effect without a \"readout_time\"");
  return e;
}

}  // namespace

double Exposure::begin(int x, int y, int width, int height) const {
  double t = open;
  if (readout > 0) {
    const bool columns = direction == Readout::right || direction == Readout::left;
    const int line = columns ? x : y, last = std::max(1, (columns ? width : height) - 1);
    const bool backwards = direction == Readout::up || direction == Readout::left;
    const double fraction = std::clamp(double(line) / last, 0.0, 1.0);
    t += readout * (backwards ? 1 - fraction : fraction);
  }
  return t;
}

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
  exposure_ = read_exposure(p);
  film_->set_exposure(exposure_.duration());
}

Transform Sensor::read_motion(const Properties& p) {
  motion_ = p.get_motion("to_world");
  if (!motion_.is_moving()) return motion_.first();
  // A sensor may be scaled as a whole, but does not grow.
  if (!motion_.is_rigid()) throw p.error("to_world", "a sensor must not be scaled or sheared while it moves");
  return motion_.first();
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
  if (motion()) throw properties().error("to_world", "a sensor of a batch cannot move");
  if (disperses())
    throw Error(properties().where(),
                "a sensor whose rays depend on the wavelength cannot be one of a batch");
  for (const char* name : {"shutter_open", "shutter_close", "readout_time"})
    if (properties().has(name))
      throw properties().error(name, "all sensors of a batch have one exposure: give it to the batch");
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
  at.motion = sensor.motion();
  sensor.fit(at);
  return at;
}

Transform PlacedSensor::moved_to(float time) const {
  return motion->at(double(time)) * motion->first().inverse();
}

SensorRay PlacedSensor::moved(SensorRay r, float time) const {
  const Transform moved = moved_to(time);
  r.ray.o = moved.point(r.ray.o), r.ray.d = normalize(moved.vector(r.ray.d));
  return r;
}

std::optional<SensorConnection> PlacedSensor::sample_direct_moved(const Vec3& reference, Vec2 lens,
                                                                  float time) const {
  const Transform moved = moved_to(time);
  auto c = sensor->sample_direct(*this, moved.inverse().point(reference), lens);
  if (c) c->wo = normalize(moved.vector(c->wo)), c->p = moved.point(c->p);
  return c;
}

std::optional<SensorResponse> PlacedSensor::eval_moved(const Vec3& p, const Vec3& d, std::optional<Vec2> seen,
                                                       float time) const {
  const Transform back = moved_to(time).inverse();
  return sensor->eval(*this, back.point(p), normalize(back.vector(d)), seen);
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "sensor",
    .parameters =
        {{"film", "film", "", "hdrfilm", "the measured quantity and its storage"},
         {"sampler", "sampler", "", "sobol", "sample points"},
         {"medium", "medium", "", "the medium inside the surfaces around it",
          "medium around the sensor; needed only if no surface bounds that medium"},
         {"srf", "spectrum", "", "1", "spectral response that multiplies the film's"},
         {"shutter_open", "float", "s", "0", "begin of the exposure"},
         {"shutter_close", "float", "s", "shutter_open",
          "end of the exposure. The film measures the mean over the exposure, or the integral for "
          "quantities over time"},
         {"readout_time", "float", "s", "0",
          "rolling shutter: time from the beginning of the exposure of the first row to that of the last "
          "one. For integrators that follow paths from the sensor only"},
         {"readout_direction", "string", "", "down",
          "where the readout runs in the picture: down, up, right or left"}},
    .belongs_to_shapes = true,
    .is_reusable = true});

}  // namespace aureole
