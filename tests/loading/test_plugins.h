// SPDX-License-Identifier: Apache-2.0
// Small plug-ins for the tests of the scene reader, which depend on no real one.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "loading/load_text.h"

namespace aureole::test {

/// Reads one parameter of every type and counts its instances.
struct TestBsdf : Object {
  explicit TestBsdf(const Properties& p) : Object(p) {
    ++instances;
    p.get_bool("flag", false);
    p.get_int("count", 1, Range::non_negative());
    amount = p.get_float("amount", 0, Range::unit());
    p.get_string("text", "");
    direction = p.get_vec3("direction", {});
    to_world = p.get_transform("to_world");
    length = p.get_length_m("thickness", 1);
    if (const auto* e = p.find("reflectance"))
      if (const auto* s = Properties::spectrum_of(e->value)) spectrum = *s;
    if (p.has("filename")) file = p.get_file("filename");
    children = p.get_children<TestBsdf>("bsdf");
  }
  static constexpr const char* kFamily = "a bsdf";
  static inline int instances = 0;
  double amount, length;
  Vec3 direction;
  Transform to_world;
  SpectrumLiteral spectrum;
  std::filesystem::path file;
  std::vector<std::shared_ptr<TestBsdf>> children;
};

/// Takes any child of its family's kind; stands for the objects around the tested ones.
struct TestObject : Object {
  explicit TestObject(const Properties& p) : Object(p) {
    children = p.get_children<Object>("parts");
    p.get_int("sample_count", 4);
    p.get_int("seed", 0);
    p.find("wavelength_min"), p.find("wavelength_max");
    if (p.get_string("message", "") == "throw") throw std::runtime_error("thrown by the plug-in");
  }
  static constexpr const char* kFamily = "an object";
  std::vector<ObjectPtr> children;
};

/// Holds the objects that tests look at.
struct TestSensor : Sensor {
  explicit TestSensor(const Properties& p) : Sensor(p), children(p.get_children<Object>("parts")) {}
  SensorRay sample_ray(const PlacedSensor&, Vec2, Vec2) const override { return {}; }
  std::vector<ObjectPtr> children;
};

struct TestEmitter : Emitter {
  explicit TestEmitter(const Properties& p) : Emitter(p) {}
  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2,
                                            const Wavelengths&) const override {
    return {};
  }
  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2, Vec2,
                                       const Wavelengths&) const override {
    return {};
  }
  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3&) const override {
    return {};
  }
  SampledSpectrum power_spectrum(const Light&) const override { return {}; }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }
};

/// A table of these names; of those in `files`, as files.
inline PluginDoc documented(const std::vector<std::string>& names, const std::vector<std::string>& files) {
  PluginDoc doc;
  for (const std::string& name : names) doc.parameters.push_back({name, "", "", "", ""});
  for (const std::string& name : files) doc.parameters.push_back({name, "file", "", "", ""});
  return doc;
}
inline const std::vector<std::string> kObjectNames = {"parts",   "sample_count",   "seed",
                                                      "message", "wavelength_min", "wavelength_max"};

/// A template instead of AUREOLE_PLUGIN: as inline variables these register once, however many tests include
/// them.
template <class T>
PluginInfo test_plugin(const std::string& family, const std::string& name,
                       const std::vector<std::string>& parameters,
                       const std::vector<std::string>& files = {}) {
  return {family, name, documented(parameters, files),
          [](const Properties& p) { return ObjectPtr(std::make_shared<T>(p)); }};
}

inline const PluginRegistration kTestPlugins[] = {
    PluginRegistration(test_plugin<TestBsdf>(
        "bsdf", "test_bsdf",
        {"flag", "count", "amount", "text", "direction", "to_world", "thickness", "reflectance", "bsdf"},
        {"filename"})),
    PluginRegistration(test_plugin<TestEmitter>("emitter", "test_emitter", {"sampling_weight"})),
    PluginRegistration(test_plugin<TestObject>("integrator", "test_integrator", kObjectNames)),
    PluginRegistration(test_plugin<TestObject>("integrator", "test_integrator2", kObjectNames)),
    PluginRegistration(test_plugin<TestSensor>("sensor", "test_sensor", {"parts"})),
    PluginRegistration(test_plugin<TestObject>("film", "test_film", kObjectNames)),
    PluginRegistration(test_plugin<TestObject>("sampler", "test_sampler", kObjectNames)),
    PluginRegistration(test_plugin<TestObject>("sampler", "test_sampler2", kObjectNames)),
    PluginRegistration(test_plugin<TestObject>("texture", "test_texture", kObjectNames)),
};

inline const std::vector<ObjectPtr>& children_of_sensor(const LoadedParts& loaded) {
  return dynamic_cast<const TestSensor&>(*loaded.parts.sensor).children;
}
/// The bsdf made from `parameters`, through the sensor that holds it.
inline std::shared_ptr<TestBsdf> bsdf(const std::string& parameters) {
  const LoadedParts s = load_parts(
      "test.xml",
      kHead + "<integrator type='test_integrator'/><sensor type='test_sensor'>\n<bsdf type='test_bsdf'>" +
          parameters + "</bsdf></sensor></scene>",
      {});
  return std::dynamic_pointer_cast<TestBsdf>(children_of_sensor(s).at(0));
}
/// The error of a bsdf with one parameter, without the place.
inline std::string problem(const std::string& parameter) {
  const std::string e = error_of("<bsdf type='test_bsdf'>\n" + parameter + "</bsdf>");
  EXPECT_TRUE(e.starts_with("test.xml:4:")) << e;
  const auto text = e.find(": ", e.find(":4:"));
  return text == std::string::npos ? e : e.substr(text + 2);
}

}  // namespace aureole::test
