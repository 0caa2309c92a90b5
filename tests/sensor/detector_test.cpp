// SPDX-License-Identifier: Apache-2.0
// The sensor `detector` and the emitter `beam`, both ends of an instrument, in scenes whose answers are known.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/render/job.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

const std::string kFilm =
    R"(<film type="hdrfilm"><integer name="width" value="3"/><integer name="height" value="1"/>
    <string name="pixel_format" value="luminance"/><rfilter type="box"/></film>)";

LoadedScene scene_of(const std::string& content) {
  return load_scene_from_string("<scene version=\"3.0.0\">" + content + "</scene>", "detector.xml");
}
std::vector<double> render(const std::string& content, std::int64_t samples = 4096) {
  RenderOptions options;
  options.end = samples;
  RenderJob job(scene_of(content), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  const Image picture = job.state().picture();
  return {picture.pixels.begin(), picture.pixels.end()};
}
std::string error_of(const std::string& content) {
  try {
    scene_of(content);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}
std::string detector(const std::string& rest) {
  return "<sensor type=\"detector\">" + rest + kFilm + "</sensor>";
}
const std::string kThree =
    R"(<string name="directions" value="0 0, 50 30, 75 200"/><float name="field_radius" value="0.2"/>)";
const std::string kPath = "<integrator type=\"path\"/>";

TEST(Detector, ReadsTheRadianceOfEvenLightAtAnySize) {
  for (const std::string size :
       {R"(<float name="aperture_radius" value="0.01"/>)", R"(<float name="aperture_radius" value="0.5"/>)",
        R"(<string name="aperture_size" value="0.3, 0.05"/>)"})
    for (const double v :
         render(kPath + "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"2\"/></emitter>" +
                detector(kThree + size)))
      EXPECT_NEAR(v, 2, 4e-3) << size;
}

TEST(Detector, ViewsItsFieldAlone) {
  // A bright disc of the field's size; beside it all is dark.
  for (const double scale : {1.0, 1.5}) {
    const auto v = render(
        kPath + "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"" +
        std::to_string(0.2 * scale) +
        "\"/></transform><emitter type=\"area\"><spectrum name=\"radiance\" value=\"1\"/></emitter></shape>" +
        detector(kThree + R"(<float name="aperture_radius" value="0.1"/>)"));
    for (const double x : v) EXPECT_NEAR(x, 1, 2e-3) << scale;
  }
  // A disc of half the radius fills a quarter of the field.
  const auto quarter =
      render(kPath + R"(<shape type="disk"><transform name="to_world"><scale value="0.1"/></transform>
      <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)" +
             detector(kThree + R"(<float name="aperture_radius" value="0.01"/>)"));
  // By the element of etendue 1/(1 + r^2)^2 its share is (0.01/1.01)/(0.04/1.04).
  EXPECT_NEAR(quarter[0], 0.01 / 1.01 / (0.04 / 1.04), 5e-4);
}

// Light tracing connects to apertures of any size: a lit wall beside a lamp, viewed from three sides.
TEST(Detector, LightTracingReadsWhatPathTracingReads) {
  const std::string scene =
      R"(<shape type="rectangle"><transform name="to_world"><scale x="1" y="0.4"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0.6"/></bsdf></shape>
      <shape type="disk"><transform name="to_world"><scale value="0.3"/><rotate y="1" angle="200"/><translate x="0.6" z="1"/></transform>
      <emitter type="area"><spectrum name="radiance" value="5"/></emitter></shape>)" +
      detector(kThree + R"(<float name="aperture_radius" value="0.1"/>)");
  const auto path = render("<integrator type=\"path\"/>" + scene, 1 << 14),
             light = render("<integrator type=\"ptracer\"/>" + scene, 1 << 17);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GT(path[k], 0.01) << k;
    EXPECT_NEAR(light[k], path[k], 0.02 * path[k]) << k;
  }
}

TEST(Detector, BadParametersAreLocatedErrors) {
  EXPECT_NE(
      error_of(
          detector(
              R"(<string name="directions" value="0 0, 50"/><float name="field_radius" value="1"/><float name="aperture_radius" value="1"/>)"))
          .find("expected pairs"),
      std::string::npos);
  EXPECT_NE(
      error_of(
          detector(
              R"(<string name="directions" value="0 0"/><float name="field_radius" value="1"/><float name="aperture_radius" value="1"/>)"))
          .find("there are 1 directions for 3 pixels"),
      std::string::npos);
  EXPECT_NE(
      error_of(
          detector(
              R"(<string name="directions" value="0 0, 200 0, 1 1"/><float name="field_radius" value="1"/><float name="aperture_radius" value="1"/>)"))
          .find("a polar angle is 200"),
      std::string::npos);
  EXPECT_NE(error_of(detector(kThree + R"(<string name="aperture_size" value="1"/>)"))
                .find("expected two positive numbers"),
            std::string::npos);
  EXPECT_NE(
      error_of(
          detector(
              kThree +
              R"(<float name="aperture_radius" value="1"/><transform name="to_world"><scale value="2"/></transform>)"))
          .find("must not scale"),
      std::string::npos);
}

/// A meter of half the target's radius, and one beside the target.
std::string meter(double x) {
  return "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"0.05\"/><translate x=\"" +
         std::to_string(x) +
         R"("/></transform><bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf><sensor type="irradiancemeter">
      <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><string name="pixel_format" value="luminance"/>
      <rfilter type="box"/></film></sensor></shape>)";
}
const std::string kBeam =
    R"(<shape type="disk"><transform name="to_world"><scale value="0.2"/><rotate x="1" angle="180"/><translate z="2"/></transform>
    <emitter type="beam"><spectrum name="radiance" value="3"/><float name="target_radius" value="0.1"/></emitter></shape>)";

TEST(Beam, LightsItsTargetEvenlyAndNothingBeside) {
  // Irradiance of a disc of radius a at height h on its axis: pi L a^2/(a^2 + h^2).
  const double expected = M_PI * 3 * 0.04 / (0.04 + 4);
  for (const std::string integrator : {"path", "ptracer"}) {
    const std::string head = "<integrator type=\"" + integrator + "\"/>";
    EXPECT_NEAR(render(head + kBeam + meter(0), 1 << 15)[0], expected, 0.01 * expected) << integrator;
    EXPECT_EQ(render(head + kBeam + meter(0.2), 1 << 12)[0], 0) << integrator;
  }
}

TEST(Beam, BadParametersAreLocatedErrors) {
  const auto beam = [](const std::string& parameters) {
    return "<shape type=\"disk\"><emitter type=\"beam\">" + parameters + "</emitter></shape>" + meter(0);
  };
  EXPECT_NE(error_of(beam("")).find("target_radius"), std::string::npos);
  EXPECT_NE(
      error_of(
          beam(R"(<float name="target_radius" value="1"/><vector name="target_normal" x="0" y="0" z="0"/>)"))
          .find("expected a direction"),
      std::string::npos);
  EXPECT_NE(
      error_of(beam(R"(<float name="target_radius" value="1"/><point name="target" x="0" y="0" z="-3"/>)"))
          .find("faces away from the disc"),
      std::string::npos);
}

}  // namespace
}  // namespace aureole::test
