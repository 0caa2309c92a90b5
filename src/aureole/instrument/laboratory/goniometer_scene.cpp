// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/goniometer_scene.h"

#include <fmt/format.h>

#include <cmath>

#include "aureole/math/vec.h"
#include "aureole/plugin/array.h"

namespace aureole {
namespace {

constexpr double kReceiverGap = 1e-4;  ///< of a cosine receiver from the sample [m]

}  // namespace

std::array<double, 3> gonio_direction(double theta, double phi) {
  const double t = theta * kDegree, a = phi * kDegree;
  return {std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)};
}

void GonioScenes::add_specimen(const Specimen& specimen, double turn) {
  content_ += specimen_shape(specimen,
                             {.matrix = matrix_text(Transform::rotate(0, 0, 1, -turn)),
                              .radius = 0.5 * s_.sample_m / bench_.length_unit_m(),
                              .length_unit_m = bench_.length_unit_m()},
                             given_);
}

void GonioScenes::add_lamp(double theta, double half_angle) {
  const double distance = kLampFarther * s_.distance_m;
  const std::array<double, 3> d = gonio_direction(theta, 0);
  const double at = distance / bench_.length_unit_m();
  add_disc(facing({d[0] * at, d[1] * at, d[2] * at}, {-d[0], -d[1], -d[2]}),
           distance * std::tan(half_angle * kDegree),
           fmt::format("<emitter type=\"beam\"><spectrum name=\"radiance\" value=\"1\"/>"
                       "<float name=\"target_radius\" value=\"{}\"/></emitter>",
                       bench_.length(0.5 * s_.lit_m)));
}

void GonioScenes::add_floor() {
  const double below = -2 * s_.sample_m / bench_.length_unit_m();
  add_disc(facing({0, 0, below}, {0, 0, 1}), 100 * s_.sample_m,
           "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0\"/></bsdf>");
}

void GonioScenes::add_even_light() {
  add_floor();
  content_ += "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"1\"/></emitter>";
}

void GonioScenes::add_light(const Image& map) {
  add_floor();
  std::vector<double> values;
  const std::size_t channels = map.channels.size() >= 3 ? 3 : 1;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (std::size_t c = 0; c < channels; ++c) values.push_back(double(map.at(x, y, c)));
  given_["light"] = std::make_shared<Array>(
      std::vector<std::size_t>{std::size_t(map.height), std::size_t(map.width), channels}, std::move(values));
  // The map's +y becomes the sample's normal.
  content_ +=
      "<emitter type=\"envmap\"><given name=\"data\" key=\"light\"/><transform name=\"to_world\"><rotate x=\"1\" "
      "angle=\"90\"/></transform></emitter>";
}

void GonioScenes::add_detectors(const std::vector<std::array<double, 2>>& directions) {
  detectors_ = directions.size();
  std::string text;
  for (const auto& d : directions) text += fmt::format("{:.9g} {:.9g} ", d[0], d[1]);
  content_ += fmt::format(
      "<sensor type=\"detector\"><string name=\"directions\" value=\"{}\"/><float name=\"distance\" value=\"{}\"/>"
      "<float name=\"field_radius\" value=\"{}\"/><float name=\"aperture_radius\" value=\"{}\"/>{}</sensor>",
      text, bench_.length(s_.distance_m), bench_.length(0.5 * s_.viewed_m),
      bench_.length(s_.distance_m * std::tan(s_.detector_angle * kDegree)), bench_.film(detectors_));
}

void GonioScenes::add_receiver(bool faces_up) {
  const double z = faces_up ? 0 : kReceiverGap / bench_.length_unit_m();
  add_disc(facing({0, 0, z}, {0, 0, faces_up ? 1.0 : -1.0}), 0.5 * s_.viewed_m,
           "<bsdf type=\"null\"/><sensor type=\"irradiancemeter\">" + bench_.film(1) + "</sensor>");
}

void GonioScenes::add_receiver_beside(double x_m, double radius_m, bool is_strip) {
  const double unit = bench_.length_unit_m();
  const Transform place = facing({x_m / unit, 0, kReceiverGap / unit}, {0, 0, -1});
  const std::string meter =
      "<bsdf type=\"null\"/><sensor type=\"irradiancemeter\">" + bench_.film(1) + "</sensor>";
  if (!is_strip) {
    add_disc(place, radius_m, meter);
    return;
  }
  // The local x axis of `facing` is the world's.
  content_ += fmt::format(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"{}\" y=\"{}\"/><matrix value=\"{}\"/></transform>{}"
      "</shape>",
      bench_.length(radius_m), bench_.length(0.5 * s_.sample_m), matrix_text(place), meter);
}

void GonioScenes::add_diffuser() {
  add_specimen(lambertian_standard(1));
  add_detectors({{0, 0}});
}

void GonioScenes::add_disc(const Transform& place, double radius, const std::string& inner) {
  content_ += fmt::format(
      "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"{}\"/><matrix value=\"{}\"/></transform>{}</shape>",
      bench_.length(radius), matrix_text(place), inner);
}

}  // namespace aureole
