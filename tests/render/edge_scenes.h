// SPDX-License-Identifier: Apache-2.0
// Small scenes with edges, in units of 20 um, and what single receivers measure in them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "aureole/render/plan.h"
#include "harness/effort.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole::test {

inline std::string rectangle(const std::string& transform, const std::string& inside = "") {
  return R"(<shape type="rectangle"><transform name="to_world">)" + transform + "</transform>" + inside +
         "</shape>";
}
inline std::string grey(double reflectance) {
  return fmt::format(
      R"(<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="{}"/></bsdf></bsdf>)",
      reflectance);
}

/// A floor and a wall.
inline std::string walls() {
  return rectangle(R"(<translate z="-1"/>)", grey(0.7)) +
         rectangle(R"(<rotate x="1" angle="90"/><translate y="1"/>)", grey(0.8));
}
/// A black sheet from x = -1 to 0, the edges of which are the only ones in the scene that diffract.
inline std::string only_edges() {
  return rectangle(
      R"(<scale x="0.5" y="0.6"/><translate x="-0.5" z="0.2"/>)",
      R"(<bsdf type="freespacediffraction"><float name="scale" value="1"/>)" + grey(0) + "</bsdf>");
}
inline std::string point(const char* p) {
  return fmt::format(
      R"(<emitter type="point"><point name="position" value="{}"/><spectrum name="intensity" value="1"/></emitter>)",
      p);
}

inline constexpr const char* kIntegrators[] = {"path", "ptracer", "bdpt"};

struct EdgeMethod {
  const char* integrator;
  int samples;
  int depth = 4;
  bool diffraction = true;
};

/// The picture of a sensor that has all of its parts but film and sampler.
inline testing::Picture measured(const std::string& scene, const EdgeMethod& by, const std::string& sensor,
                                 std::uint64_t seed) {
  RenderOptions options;
  options.replicates = 16, options.seed = seed;
  const LoadedScene loaded =
      load_scene_from_string(fmt::format(
                                 R"(<scene version="3.0.0"><string name="length_unit" value="20um"/>
  <integrator type="{}"><integer name="max_depth" value="{}"/><boolean name="diffraction" value="{}"/>
    <string name="diffraction_model" value="beams"/><string name="beam_width" value="2 wavelengths"/></integrator>
  {}<sampler type="sobol"><integer name="sample_count" value="{}"/></sampler>
    <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/>
      <float name="wavelength_min" value="540"/><float name="wavelength_max" value="560"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
  </sensor>{}</scene>)",
                                 by.integrator, by.depth, by.diffraction ? "true" : "false", sensor,
                                 kSanitized ? 2 : by.samples, scene),
                             "exchange.xml");
  return testing::render(loaded, options);
}
/// Takes light from all directions alike.
inline std::string receiver(const char* place) {
  return fmt::format(
      R"(<sensor type="powermap"><transform name="to_world"><scale value="0.001"/><translate value="{}"/></transform>)",
      place);
}

/// By a z-test: within four standard errors, which are small enough to mean something.
inline void expect_equal(const std::string& name, const testing::Picture& a, const testing::Picture& b,
                         double precision) {
  const double error = std::hypot(a.all_error, b.all_error);
  std::printf("%s: %.5g +- %.2g and %.5g +- %.2g, z %+.2f\n", name.c_str(), a.all, a.all_error, b.all,
              b.all_error, (a.all - b.all) / error);
  if (kSanitized) return;
  EXPECT_NEAR(a.all, b.all, 4 * error) << name;
  EXPECT_LT(error, precision * a.all) << name;
}

}  // namespace aureole::test
