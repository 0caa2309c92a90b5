// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/goniophotometer_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/version.h"
#include "aureole/loading/document.h"
#include "aureole/scene/scene.h"

namespace aureole {

namespace {

/// Returns the number of steps of an angle, which must divide `whole` degrees.
int steps_of(const char* option, double step, double whole) {
  const double count = whole / step;
  if (!(step > 0 && count <= 3600 && std::abs(count - std::round(count)) < 1e-6))
    throw Error(
        fmt::format("{} {:g}: must divide {:g} degrees, by 0.1 degrees at least", option, step, whole));
  return int(std::lround(count));
}

std::string direction_text(const std::vector<double>& v) { return fmt::format("{:.9g}", fmt::join(v, ", ")); }

std::vector<double> unit_direction(const char* option, std::vector<double> v) {
  const double l = v.size() == 3 ? std::hypot(v[0], v[1], v[2]) : 0;
  if (!(l > 1e-9 && std::isfinite(l)))
    throw Error(fmt::format("{} {}: is no direction", option, direction_text(v)));
  for (double& x : v) x /= l;
  return v;
}

std::vector<double> cross_product(const std::vector<double>& p, const std::vector<double>& q) {
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

/// The sensor's XML element.
std::string sensor_element(const GoniophotometerSettings& s) {
  const std::vector<double> down = unit_direction("--down", s.down);
  std::vector<double> along = s.along;
  if (along.empty())
    along = std::abs(down[0]) > 0.9 ? std::vector<double>{0, 1, 0} : std::vector<double>{1, 0, 0};
  const std::vector<double> y =
      unit_direction("--along", cross_product(down, unit_direction("--along", along)));
  const std::vector<double> x = cross_product(y, down);
  std::string matrix;
  for (std::size_t i = 0; i < 3; ++i) matrix += fmt::format("{:.9g} {:.9g} {:.9g} ", x[i], y[i], down[i]);
  return fmt::format(
      "<sensor type=\"goniophotometer\"><transform name=\"to_world\"><matrix value=\"{}\"/></transform>"
      "<film type=\"hdrfilm\"><integer name=\"width\" value=\"{}\"/><integer name=\"height\" value=\"{}\"/>"
      "<string name=\"quantity\" value=\"luminous_intensity\"/><rfilter type=\"box\"/></film>"
      "<sampler type=\"sobol\"><integer name=\"sample_count\" value=\"{}\"/></sampler></sensor>",
      matrix, steps_of("--c-step", s.c_step, 360), steps_of("--gamma-step", s.gamma_step, 180) + 1, s.spp);
}

}  // namespace

GoniophotometerSource goniophotometer_source(const GoniophotometerSettings& s,
                                             const TableProgress& progress) {
  if (s.spp < 1) throw Error(fmt::format("--spp {}: at least one sample per direction is needed", s.spp));
  GoniophotometerSource source;
  source.file = s.scene;
  source.load.defines = s.defines, source.load.tables = s.tables, source.load.check_files = s.check_files;
  source.load.integrator = s.integrator.empty() ? "ptracer" : s.integrator;
  source.load.progress = progress;
  const std::string element = sensor_element(s);
  const LoadedObjects objects = load_objects(s.scene, source.load);
  if (std::any_of(objects.objects.begin(), objects.objects.end(), [](const auto& object) {
        return std::dynamic_pointer_cast<const Sensor>(object.second) != nullptr;
      })) {
    source.sensor = element;
    return source;
  }
  constexpr const char* kScene = "scene_on_the_goniophotometer";
  source.load.defines.emplace_back(kScene, std::filesystem::path(s.scene).filename().string());
  source.text =
      "<scene version=\"3.0.0\">" + element + "<include filename=\"$" + std::string(kScene) + "\"/></scene>";
  source.file = std::filesystem::path(s.scene).parent_path() / "--goniophotometer";
  return source;
}

LoadedScene load_goniophotometer(const GoniophotometerSettings& settings) {
  const GoniophotometerSource source = goniophotometer_source(settings);
  if (source.text) return load_scene_from_string(*source.text, source.file, source.load);
  SceneDocument document(source.file, source.load);
  return document.edit({{"sensor", source.sensor}});
}

void require_luminaire(const Scene& scene) {
  for (const Light& light : scene.emitters())
    if (light.is_infinite())
      throw Error(light.properties().where(),
                  "light from infinity is none of a luminaire: leave this emitter out");
}

GoniometryOptions::Symmetry symmetry_of(const std::string& name) {
  using Symmetry = GoniometryOptions::Symmetry;
  if (name == "none") return Symmetry::none;
  if (name == "rotational") return Symmetry::rotational;
  if (name == "c0") return Symmetry::about_c0;
  if (name == "c90") return Symmetry::about_c90;
  if (name == "quadrants") return Symmetry::quadrants;
  throw Error("--symmetry " + name + ": expected none, rotational, c0, c90 or quadrants");
}

std::vector<std::pair<std::string, std::string>> measurement_keywords(const GoniophotometerSettings& settings,
                                                                      const std::string& name,
                                                                      const std::string& maker) {
  const std::filesystem::path scene = settings.scene;
  const std::string called = name.empty() ? scene.stem().string() : name;
  return {{"TEST", "calculated by aureole " + std::string(kVersion)},
          {"TESTLAB", "none: a simulation"},
          {"ISSUEDATE", "not stated"},
          {"MANUFAC", maker.empty() ? "not stated" : maker},
          {"LUMCAT", called},
          {"LUMINAIRE", called},
          {"OTHER", fmt::format("far field; {} samples per direction of {}", settings.spp,
                                scene.filename().string())}};
}

}  // namespace aureole
