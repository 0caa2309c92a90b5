// SPDX-License-Identifier: Apache-2.0
// Sensors of one value in scenes whose answers are known; batches; how a scene finds its sensor.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/render/job.h"
#include "tests/loading/load_text.h"

namespace aureole::test {
namespace {

const std::string kOne =
    "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>"
    "<string name='pixel_format' value='luminance'/></film>";
const std::string kConstant = "<emitter type='constant'><spectrum name='radiance' value='2'/></emitter>";
const std::string kBlack = "<bsdf type='diffuse'><float name='reflectance' value='0'/></bsdf>";

LoadedScene scene(const std::string& content, const LoadOptions& options = {}) {
  return load_scene_from_string("<scene version='3.0.0'><integrator type='path'/>" + content + "</scene>",
                                "meters.xml", options);
}
std::vector<double> values(const std::string& content, std::int64_t samples = 4096) {
  RenderOptions options;
  options.end = samples;
  RenderJob job(scene(content), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  const Image picture = job.state().picture();
  return {picture.pixels.begin(), picture.pixels.end()};
}
double value(const std::string& content, std::int64_t samples = 4096) {
  const auto all = values(content, samples);
  EXPECT_EQ(all.size(), 1u);
  return all.front();
}
std::string error(const std::string& content) {
  try {
    scene(content);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
std::string meter(const std::string& shape, const std::string& rest = "") {
  return "<shape type='" + shape + "'>" + rest + kBlack + "<sensor type='irradiancemeter'>" + kOne +
         "</sensor></shape>";
}

TEST(IrradianceMeter, InAConstantEnvironmentIsPiTimesRadiance) {
  for (const char* shape : {"rectangle", "sphere", "cube"})
    EXPECT_NEAR(value(kConstant + meter(shape)), 2 * M_PI, 2e-3) << shape;
  // Small, far away and turned inside out: no ray may hit the surface from which it starts.
  EXPECT_NEAR(value(kConstant + meter("sphere",
                                      "<point name='center' x='500' y='-300' z='20'/><float "
                                      "name='radius' value='0.01'/>")),
              2 * M_PI, 2e-3);
  // The inside of a sphere sees itself alone.
  EXPECT_NEAR(value(kConstant + meter("sphere", "<boolean name='flip_normals' value='true'/>")), 0, 1e-6);
}

TEST(IrradianceMeter, LooksToTheSideOfTheNormal) {
  const std::string floor =
      "<shape type='rectangle'><transform name='to_world'><scale value='20000'/><translate z='-0.001'/>"
      "</transform>" +
      kBlack + "</shape>";
  EXPECT_NEAR(value(kConstant + floor + meter("rectangle")), 2 * M_PI, 2e-3);
  EXPECT_NEAR(value(kConstant + floor + meter("rectangle", "<boolean name='flip_normals' value='true'/>")), 0,
              1e-2);
  // Over all orientations half of the directions are dark: a sphere, turned or not, above a black floor.
  for (const char* turn : {"", "<rotate x='1' angle='40'/>"})
    EXPECT_NEAR(value(kConstant + floor +
                          meter("sphere", "<transform name='to_world'>" + std::string(turn) +
                                              "<scale value='0.4'/><translate z='1.7'/></transform>"),
                      65536),
                M_PI, 0.01)
        << turn;
}

// Azimuths around a flat cylinder are not uniform over its area. Light along x falls on half of it; its mean is the
// power that meets the cross section, 2 b long and h high, over the area of all, the ellipse's perimeter times h.
TEST(IrradianceMeter, IsTheMeanOverTheAreaOfAFlatCylinder) {
  const double a = 0.2, b = 1.5;
  double perimeter = 0;
  for (int i = 0; i < 1000; ++i) {
    const double phi = 2 * M_PI * i / 1000;
    perimeter += std::hypot(a * std::sin(phi), b * std::cos(phi)) * 2 * M_PI / 1000;
  }
  EXPECT_NEAR(
      value("<emitter type='directional'><vector name='direction' x='1' y='0' z='0'/>"
            "<spectrum name='irradiance' value='3'/></emitter>" +
            meter("cylinder", "<transform name='to_world'><scale x='0.2' y='1.5' z='0.8'/></transform>")),
      3 * 2 * b / perimeter, 0.01);
}

TEST(IrradianceMeter, SeesALight) {
  // A lamp of radius r at distance d over a small patch: pi L (r / d)^2 for a sphere.
  const std::string small = "<transform name='to_world'><scale value='0.001'/></transform>";
  EXPECT_NEAR(value(meter("rectangle", small) +
                        "<shape type='sphere'><point name='center' x='0' y='0' z='4'/><emitter type='area'>"
                        "<spectrum name='radiance' value='3'/></emitter></shape>",
                    65536),
              3 * M_PI / 16, 0.01 * 3 * M_PI / 16);
  // A lamp that is its own meter, in patches of two triangles, sees nothing of itself.
  EXPECT_EQ(value("<shape type='cube'><emitter type='area'/><sensor type='irradiancemeter'>" + kOne +
                  "</sensor></shape>"),
            0);
}

TEST(IrradianceMeter, ReplacesAWideFilter) {
  const std::string wide =
      "<shape type='rectangle'><sensor type='irradiancemeter'><film type='hdrfilm'><integer name='width' "
      "value='1'/><integer name='height' value='1'/><rfilter type='gaussian'/></film></sensor></shape>";
  const auto s = scene(kConstant + wide);
  EXPECT_EQ(s.scene->film().filter().properties().type(), "box");
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("a box is used"), std::string::npos);
  // No note about the ignored filter if it is only the default of a film, or of a missing film.
  EXPECT_TRUE(scene(kConstant + meter("cube")).notes.empty());
  const auto bare = scene(kConstant + "<shape type='cube'><sensor type='irradiancemeter'/></shape>");
  EXPECT_EQ(bare.scene->film().width() * bare.scene->film().height(), 1);
}

TEST(RadianceMeter, FollowsOneRay) {
  const std::string lamp =
      "<shape type='rectangle'><emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";
  const auto seen = [&](const std::string& where) {
    return value(lamp + "<sensor type='radiancemeter'>" + where + kOne + "</sensor>", 4096);
  };
  const auto from = [](const char* x, const char* z) {
    return std::string("<point name='origin' x='") + x +
           "' y='0' z='3'/><vector name='direction' x='0' y='0' z='" + z + "'/>";
  };
  EXPECT_NEAR(seen(from("0.99", "-7")), 5, 0.01);
  EXPECT_EQ(seen(from("1.01", "-7")), 0);
  EXPECT_EQ(seen(from("0", "1")), 0);
  EXPECT_NEAR(
      seen("<transform name='to_world'><scale value='4'/><lookat origin='0.5, 0, 3' target='0.5, 0, 0' "
           "up='0, 1, 0'/></transform>"),
      5, 0.01);
  EXPECT_NE(
      error("<sensor type='radiancemeter'><point name='origin' x='0' y='0' z='0'/></sensor>").find("both"),
      std::string::npos);
  EXPECT_NE(error("<sensor type='radiancemeter'><point name='origin' x='0' y='0' z='0'/><vector "
                  "name='direction' x='0' y='0' z='0'/></sensor>")
                .find("zero"),
            std::string::npos);
  for (const char* z : {"-1e-40", "-1e-25", "-3e25"}) EXPECT_NEAR(seen(from("0", z)), 5, 0.01) << z;
  EXPECT_NE(error("<sensor type='radiancemeter'><film type='hdrfilm'/></sensor>").find("768 x 576"),
            std::string::npos);
}

TEST(Distant, MeansOverSceneTargetPointAndShape) {
  const std::string lamp =
      "<shape type='rectangle'><emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";
  const auto seen = [&](const std::string& rest, const std::string& more = "") {
    return value(lamp + more + "<sensor type='distant'>" + rest + kOne + "</sensor>", 16384);
  };
  const auto direction = [](double x, double z) {
    return "<vector name='direction' x='" + std::to_string(x) + "' y='0' z='" + std::to_string(z) + "'/>";
  };
  // The square of edge 2 in a sphere of radius sqrt(2): 4 |cos| of 2 pi.
  EXPECT_NEAR(seen(direction(0, -1)), 5 * 4 / (2 * M_PI), 0.01);
  EXPECT_NEAR(seen(direction(std::sqrt(3), -1)), 5 * 2 / (2 * M_PI), 0.01);
  EXPECT_NEAR(seen("<transform name='to_world'><rotate x='1' angle='180'/></transform>"), 5 * 4 / (2 * M_PI),
              0.01);
  EXPECT_EQ(seen(direction(0, 1)), 0) << "the back does not shine";
  EXPECT_NEAR(seen(direction(0, 1) + "<boolean name='flip_directions' value='true'/>"), 5 * 4 / (2 * M_PI),
              0.01);
  // Through a point or a shape, half of which lies beside the lamp.
  EXPECT_NEAR(seen(direction(0, -1) + "<point name='target' x='0.9' y='0' z='0'/>"), 5, 0.01);
  EXPECT_EQ(seen(direction(0, -1) + "<point name='target' x='1.1' y='0' z='0'/>"), 0);
  EXPECT_NEAR(seen(direction(0, -1) + "<shape name='target' type='cube'><transform name='to_world'><scale "
                                      "value='0.5'/><translate x='1'/></transform></shape>"),
              2.5, 0.02);
  // Something in the way, unless rays start behind it.
  const std::string lid =
      "<shape type='rectangle'><transform name='to_world'><scale value='2'/><translate "
      "z='3'/></transform>" +
      kBlack + "</shape>";
  const std::string target = direction(0, -1) + "<point name='target' x='0' y='0' z='0'/>";
  EXPECT_EQ(seen(target, lid), 0);
  EXPECT_NEAR(seen(target + "<float name='ray_offset' value='2'/>", lid), 5, 0.01);
  EXPECT_NE(error("<sensor type='distant'>" + direction(0, 1) + "<transform name='to_world'/></sensor>")
                .find("either"),
            std::string::npos);
  EXPECT_NE(
      error("<sensor type='distant'><string name='target' value='x'/></sensor>").find("point or a shape"),
      std::string::npos);
  EXPECT_NE(error("<sensor type='distant'><bsdf name='target' type='diffuse'/></sensor>").find("a shape"),
            std::string::npos);
}

std::string batch(int width, int height, const std::string& sensors) {
  return "<sensor type='batch'>" + sensors + "<film type='hdrfilm'><integer name='width' value='" +
         std::to_string(width) + "'/><integer name='height' value='" + std::to_string(height) +
         "'/><string name='pixel_format' value='luminance'/></film></sensor>";
}

TEST(Batch, SensorsFillTheirParts) {
  const std::string film20 =
      "<film type='hdrfilm'><integer name='width' value='20'/><integer name='height' "
      "value='30'/></film>";
  const std::string cameras[] = {
      "<sensor type='perspective'><string name='fov_axis' value='y'/><float name='fov' value='40'/>",
      "<sensor type='orthographic'><transform name='to_world'><rotate y='1' angle='50'/></transform>",
      "<sensor type='thinlens'><float name='aperture_radius' value='0.2'/>"};
  std::string all;
  for (const auto& c : cameras) all += c + "</sensor>";
  const auto together = scene(kConstant + batch(60, 30, all));
  ASSERT_TRUE(together.scene->sensor().uses_lens());
  for (int i = 0; i < 3; ++i) {
    const auto alone = scene(kConstant + cameras[i] + film20 + "</sensor>");
    for (const Vec2 at : {Vec2{0.5f, 0.25f}, Vec2{10, 15}, Vec2{19.75f, 29.5f}}) {
      const Ray a = alone.scene->sensor().sample_ray(at, {0.3f, 0.8f}).ray;
      const Ray b = together.scene->sensor().sample_ray({at.x + 20 * float(i), at.y}, {0.3f, 0.8f}).ray;
      EXPECT_LT(length(a.d - b.d), 1e-6) << i;
      EXPECT_LT(length(a.o - b.o), 1e-6) << i;
    }
  }
}

TEST(Batch, HoldsMetersOfShapes) {
  const std::string black_sphere =
      "<shape type='sphere' id='ball'><point name='center' x='50' y='0' z='0'/>" + kBlack +
      "<sensor type='irradiancemeter'/></shape>";
  const std::string lamp =
      "<shape type='rectangle'><emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";
  const auto v =
      values(kConstant + lamp +
             batch(3, 1,
                   "<sensor type='radiancemeter'><transform name='to_world'><lookat origin='0, 0, 2' "
                   "target='0, 0, 0' up='0, 1, 0'/></transform></sensor><ref id='ball'/><sensor "
                   "type='distant'><vector name='direction' x='0' y='0' z='-1'/><point "
                   "name='target' x='0' y='0' z='0'/></sensor>") +
             black_sphere);
  ASSERT_EQ(v.size(), 3u);
  EXPECT_NEAR(v[0], 5, 0.01);
  EXPECT_NEAR(v[1], 2 * M_PI, 2e-2) << "the lamp covers next to nothing";
  EXPECT_NEAR(v[2], 5, 0.01);
}

TEST(Batch, NotesFilmsThatItDoesNotUse) {
  const std::string camera = "<sensor type='perspective'><film type='hdrfilm'/></sensor>";
  const auto s = scene(kConstant + batch(4, 2, camera + "<sensor type='orthographic'/>"));
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("no effect"), std::string::npos);
  EXPECT_EQ(s.scene->film().width(), 4);
}

TEST(Batch, Errors) {
  const std::string camera = "<sensor type='perspective'/>";
  EXPECT_NE(error(batch(10, 10, camera + camera + camera)).find("multiple of the number of sensors, 3"),
            std::string::npos);
  EXPECT_NE(error(batch(10, 10, "")).find("at least one"), std::string::npos);
  EXPECT_NE(error(batch(10, 10, batch(10, 10, camera))).find("another batch"), std::string::npos);
  EXPECT_NE(error(batch(2, 2, camera + "<sensor type='radiancemeter'/>")).find("1 x 2"), std::string::npos);
  EXPECT_NE(error(batch(2, 1, camera + "<sensor type='perspective'><float name='srf' value='1'/></sensor>"))
                .find("one response"),
            std::string::npos);
  EXPECT_NE(error(batch(2, 1, "<shape type='cube'/>" + camera)).find("sensor of its own"), std::string::npos);
  EXPECT_NE(error(batch(2, 1, "<sensor type='perspective' id='c'/><ref id='c'/>")).find("twice"),
            std::string::npos);
}

TEST(SceneSensor, MaySitOnAShape) {
  // The first in the file, whose sampler the command line changes and whose film sets the range.
  const std::string shape =
      "<shape type='sphere'><sensor type='irradiancemeter'><sampler type='independent'/><film type='hdrfilm'>"
      "<integer name='width' value='1'/><integer name='height' value='1'/><float name='wavelength_min' "
      "value='400'/><float name='wavelength_max' value='600'/></film></sensor></shape>";
  LoadOptions options;
  options.sampler = "sobol";
  options.sample_count = 48;
  const auto s = scene(kConstant + shape + "<sensor type='perspective'/>", options);
  EXPECT_EQ(s.scene->sensor().properties().type(), "irradiancemeter");
  EXPECT_EQ(s.scene->sensor().sampler().properties().type(), "sobol");
  EXPECT_EQ(s.scene->sensor().sampler().sample_count(), 48);
  EXPECT_EQ(s.scene->wavelengths().grid().min_nm, 400);
  EXPECT_EQ(s.scene->wavelengths().grid().max_nm, 600);
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("only the first sensor"), std::string::npos);

  const auto second = scene(kConstant + "<sensor type='perspective'/>" + shape);
  EXPECT_EQ(second.scene->sensor().properties().type(), "perspective");
  EXPECT_EQ(second.scene->wavelengths().grid().max_nm, 830);
  EXPECT_EQ(second.notes.size(), 1u);
}

TEST(SceneSensor, Errors) {
  EXPECT_NE(error("<sensor type='irradiancemeter'/>").find("child of the shape"), std::string::npos);
  EXPECT_NE(error("<shape type='cube'><sensor type='perspective'/></shape>").find("cannot sit on a shape"),
            std::string::npos);
  EXPECT_NE(
      error("<shape type='cube'><sensor type='irradiancemeter'/><sensor type='irradiancemeter'/></shape>")
          .find("at most one"),
      std::string::npos);
  EXPECT_NE(
      error("<shape type='cube'><sensor type='irradiancemeter' id='m'/></shape><shape type='sphere'><ref "
            "id='m'/></shape>")
          .find("two shapes"),
      std::string::npos);
  // If a shape fails, its sensor is not reported as missing.
  EXPECT_EQ(
      error("<shape type='sphere'><float name='radius' value='-1'/><sensor type='irradiancemeter'/></shape>")
          .find("no <sensor>"),
      std::string::npos);
}

}  // namespace
}  // namespace aureole::test
