// SPDX-License-Identifier: Apache-2.0
// Light fields: synthetic apertures against pictures of a thin lens, and closed forms of a point.
#include "aureole/instrument/lightfield/light_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/core/error.h"
#include "aureole/render/job.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

/// The light field of a luminous point at (px, py, depth) in the picture's directions: in each view a pixel, spread bilinearly.
LightField field_of_point(double px, double py, double depth) {
  LightField f;
  constexpr int kPixels = 101;
  f.axes = {9, 9, kPixels, kPixels, 0.9, 0.9, 2, 2};
  f.mosaic.width = f.mosaic.height = 9 * kPixels, f.mosaic.channels = {"Y"};
  f.mosaic.pixels.assign(std::size_t(f.mosaic.width) * std::size_t(f.mosaic.height), 0.f);
  const double pixel = f.axes.field_width / kPixels;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      const auto s = f.axes.position(i, j);
      const double u = (s[0] + (px - s[0]) * 2 / depth) / pixel + 50,
                   v = (s[1] + (py - s[1]) * 2 / depth) / pixel + 50;
      const int a = int(std::floor(u)), b = int(std::floor(v));
      for (int dj = 0; dj < 2; ++dj)
        for (int di = 0; di < 2; ++di)
          f.mosaic.at(i * kPixels + a + di, j * kPixels + b + dj, 0) +=
              float((di ? u - a : 1 - u + a) * (dj ? v - b : 1 - v + b));
    }
  return f;
}
/// Sum, centre and root mean square radius of a picture, in pixels.
std::array<double, 4> moments(const Image& p) {
  double sum = 0, x = 0, y = 0, xx = 0;
  for (int j = 0; j < p.height; ++j)
    for (int i = 0; i < p.width; ++i) {
      const double v = double(p.at(i, j, 0));
      sum += v, x += v * i, y += v * j, xx += v * (i * i + j * j);
    }
  x /= sum, y /= sum;
  return {sum, x, y, std::sqrt(xx / sum - x * x - y * y)};
}

TEST(LightField, RefocusingBringsAPointTogether) {
  const LightField f = field_of_point(0.31, -0.17, 3);
  const double pixel = 2 / 101.0;
  // In focus the point lies where a camera in the middle sees it; all views agree but for the bilinear spread.
  const auto sharp = moments(light_field_picture(f, 0, 0, 0.8, 3));
  EXPECT_NEAR(sharp[0], 1, 1e-3);
  EXPECT_NEAR(sharp[1], 50 + 0.31 * 2 / 3 / pixel, 0.01);
  EXPECT_NEAR(sharp[2], 50 - 0.17 * 2 / 3 / pixel, 0.01);
  EXPECT_LT(sharp[3], 1);
  // Out of focus a view at s sees it at s d (1/focus - 1/depth) from there: the spread of the views' places.
  const auto blurred = moments(light_field_picture(f, 0, 0, 0.8, 1.5));
  double squares = 0;
  int count = 0;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      const auto s = f.axes.position(i, j);
      if (std::hypot(s[0], s[1]) <= 0.4) squares += s[0] * s[0] + s[1] * s[1], ++count;
    }
  const double expected = std::sqrt(squares / count) * 2 * (1 / 1.5 - 1 / 3.0) / pixel;
  EXPECT_NEAR(blurred[3], expected, 0.03 * expected);
  // A camera at another place sees it there.
  const auto moved = moments(light_field_picture(f, 0.2, 0.1, 0, 3));
  EXPECT_NEAR(moved[1], 50 + (0.2 + (0.31 - 0.2) * 2 / 3) / pixel, 0.01);
  EXPECT_NEAR(moved[2], 50 + (0.1 + (-0.17 - 0.1) * 2 / 3) / pixel, 0.01);
}

TEST(LightField, AxesInTheHeader) {
  LightField f = field_of_point(0, 0, 3);
  const std::string axes = f.axes.text();
  const LightField back = light_field_of(f.mosaic, axes, "x.exr");
  EXPECT_EQ(back.axes.text(), axes);
  EXPECT_THROW(light_field_of(f.mosaic, "", "x.exr"), Error);
  Image small = f.mosaic;
  small.height = 9;
  EXPECT_THROW(light_field_of(small, axes, "x.exr"), Error);
  EXPECT_THROW(light_field_picture(f, 0.05, 0.05, 0.01, 3), Error);  // between the views
  EXPECT_THROW(light_field_picture(f, 0, 0, 0.1, 0), Error);
}

TEST(LightField, LightPathsSeeItAsItsOwnPathsDo) {
  const auto mean = [](const std::string& integrator, const std::string& positions) {
    const LoadedScene scene = load_scene_from_string(
        "<scene version='3.0.0'><integrator type='" + integrator +
            "'/><sensor type='lightfield'><integer name='views_x' value='3'/><integer name='views_y' value='2'/>"
            "<float name='aperture_width' value='1'/><float name='aperture_height' value='0.5'/>"
            "<float name='plane_distance' value='4'/><float name='field_width' value='3'/><string name='positions' value='" +
            positions +
            "'/><transform name='to_world'><lookat origin='1, 0.5, -4' target='0, 0, 0' up='0, 1, 0'/></transform>"
            "<film type='hdrfilm'><integer name='width' value='6'/><integer name='height' value='4'/>"
            "<string name='quantity' value='luminance'/><rfilter type='box'/></film></sensor><shape type='sphere'/>"
            "<emitter type='point'><point name='position' x='2' y='3' z='-3'/><string name='amount' value='100 cd'/></emitter></scene>",
        "field.xml", {});
    RenderOptions options;
    options.end = 16384;
    RenderJob job(scene, options);
    job.run(std::atomic<bool>(false));
    return job.state().picture().pixels;
  };
  for (const char* positions : {"cell", "point"}) {
    const auto path = mean("path", positions), light = mean("ptracer", positions),
               both = mean("bdpt", positions);
    double all = 0, of_light = 0, of_both = 0;
    for (std::size_t i = 0; i < path.size(); ++i)
      all += double(path[i]), of_light += double(light[i]), of_both += double(both[i]);
    EXPECT_NEAR(of_light, all, 0.02 * all) << positions;
    EXPECT_NEAR(of_both, all, 0.01 * all) << positions;
    // The first view is in its place: its pixels agree, too.
    for (const std::size_t i : {0u, 7u, 16u})
      EXPECT_NEAR(double(both[i]), double(path[i]), 0.05 * all / 24) << i;
  }
}

const std::string kBalls =
    "<shape type='sphere'><point name='center' x='-0.5' y='0.1' z='3'/><float name='radius' value='0.3'/>"
    "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"
    "<shape type='sphere'><point name='center' x='1.4' y='-0.4' z='7'/><float name='radius' value='0.5'/>"
    "<emitter type='area'><rgb name='radiance' value='0.6'/></emitter></shape>"
    "<emitter type='constant'><rgb name='radiance' value='0.1'/></emitter></scene>";

TEST(LightField, AFullApertureIsAThinLens) {
  // The mean over the views of a round aperture, refocused, is the picture of a thin lens with that aperture.
  TemporaryFolder folder;
  folder.write(
      "field.xml",
      "<scene version='3.0.0'><integrator type='path'/><sensor type='lightfield'><integer name='views_x' value='16'/>"
      "<float name='aperture_width' value='0.4'/><float name='plane_distance' value='4'/>"
      "<float name='field_width' value='4'/><film type='hdrfilm'><integer name='width' value='960'/>"
      "<integer name='height' value='640'/><string name='pixel_format' value='luminance'/><rfilter type='box'/></film>"
      "<sampler type='sobol'><integer name='sample_count' value='16'/></sampler></sensor>" +
          kBalls);
  folder.write(
      "lens.xml",
      "<scene version='3.0.0'><integrator type='path'/><sensor type='thinlens'><float name='fov' value='53.130102'/>"
      "<float name='aperture_radius' value='0.2'/><float name='focus_distance' value='3'/><film type='hdrfilm'>"
      "<integer name='width' value='60'/><integer name='height' value='40'/><string name='pixel_format' value='luminance'/>"
      "<string name='component_format' value='float32'/><rfilter type='box'/></film>"
      "<sampler type='sobol'><integer name='sample_count' value='1024'/></sampler></sensor>" +
          kBalls);
  ProgramEnd end = run_program(
      folder.path, {"lightfield", "field.xml", "-o", "a.exr", "--diameter", "0.4", "--focus", "3"});
  ASSERT_EQ(end.exit_code, 0) << end.output;
  end = run_program(folder.path, {"render", "lens.xml", "-o", "b.exr"});
  ASSERT_EQ(end.exit_code, 0) << end.output;
  const Image a = read_image(folder.path / "a.exr"), b = read_image(folder.path / "b.exr");
  ASSERT_EQ(a.width, 60);
  ASSERT_EQ(a.height, 40);
  double difference = 0, contrast = 0, mean = 0;
  for (const float v : b.pixels) mean += double(v) / double(b.pixels.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    difference += std::pow(double(a.pixels[i]) - double(b.pixels[i]), 2);
    contrast += std::pow(double(b.pixels[i]) - mean, 2);
  }
  // The margin, which the outer views lack, and the bilinear filter differ.
  EXPECT_LT(std::sqrt(difference / contrast), 0.12);
  // The light field itself can be read again, and seen from elsewhere.
  end = run_program(folder.path,
                    {"lightfield", "field_field.exr", "-o", "c.png", "--at", "0.1,-0.05", "--focus", "7"});
  ASSERT_EQ(end.exit_code, 0) << end.output;
  EXPECT_NE(end.output.find("16 x 16 views over 0.4 x 0.4"), std::string::npos) << end.output;
  const auto refused = [&](std::vector<std::string> arguments, const std::string& words) {
    const ProgramEnd e = run_program(folder.path, arguments);
    EXPECT_EQ(e.exit_code, 2) << e.output;
    EXPECT_NE(e.output.find(words), std::string::npos) << e.output;
  };
  refused({"lightfield", "b.exr"}, "no light field");
  refused({"lightfield", "lens.xml"}, "needs the sensor \"lightfield\"");
  refused({"lightfield", "field_field.exr", "--at", "1,0"}, "outside of the light field");
  refused({"lightfield", "field_field.exr", "--focus", "0"}, "must be positive");
  refused({"lightfield", "field_field.exr", "-o", "x.tif"}, ".png or an .exr");
}

TEST(LightField, ADisplayShowsIt) {
  // The light field of two balls, and the display in the place of its window: cameras before it take the same pictures.
  TemporaryFolder folder;
  const auto camera = [&](const std::string& sensor, const std::string& world) {
    return "<scene version='3.0.0'><integrator type='path'/>" + sensor + world;
  };
  const std::string field =
      "<sensor type='lightfield'><integer name='views_x' value='8'/><float name='aperture_width' value='0.4'/>"
      "<float name='plane_distance' value='4'/><float name='field_width' value='4'/><string name='positions' value='point'/>"
      "<film type='hdrfilm'><integer name='width' value='960'/><integer name='height' value='640'/><rfilter type='box'/></film>"
      "<sampler type='sobol'><integer name='sample_count' value='16'/></sampler></sensor>";
  const std::string display =
      "<shape type='rectangle'><transform name='to_world'><scale x='2' y='1.33333333'/><rotate y='1' angle='180'/><translate z='4'/>"
      "</transform><emitter type='lightfielddisplay'><string name='filename' value='field.exr'/></emitter></shape></scene>";
  const auto perspective = [](double x, double y,
                              const std::string& film = "<string name='pixel_format' value='rgb'/>") {
    return "<sensor type='perspective'><float name='fov' value='53.130102'/><transform name='to_world'><translate x='" +
           std::to_string(x) + "' y='" + std::to_string(y) +
           "'/></transform><film type='hdrfilm'><integer name='width' value='120'/><integer name='height' value='80'/>" +
           film +
           "<string name='component_format' value='float32'/><rfilter type='box'/></film><sampler type='sobol'>"
           "<integer name='sample_count' value='64'/></sampler></sensor>";
  };
  folder.write("field.xml", camera(field, kBalls));
  ProgramEnd end =
      run_program(folder.path, {"lightfield", "field.xml", "--field", "field.exr", "-o", "view.exr"});
  ASSERT_EQ(end.exit_code, 0) << end.output;
  const auto rendered = [&](const std::string& scene, const std::string& name) {
    folder.write(name + ".xml", scene);
    const ProgramEnd e = run_program(folder.path, {"render", name + ".xml", "-o", name + ".exr"});
    EXPECT_EQ(e.exit_code, 0) << e.output;
    return read_image(folder.path / (name + ".exr"));
  };
  // From the middle of a cell of the plane (s, t): half a cell beside the axis. Camera space has x to the left.
  const double half_cell = 0.025;
  const Image shown = rendered(camera(perspective(half_cell, half_cell), display), "shown"),
              there = rendered(camera(perspective(half_cell, half_cell), kBalls), "there");
  double difference = 0, contrast = 0, mean = 0, mean_shown = 0;
  for (std::size_t i = 0; i < there.pixels.size(); ++i)
    mean += double(there.pixels[i]) / double(there.pixels.size()),
        mean_shown += double(shown.pixels[i]) / double(shown.pixels.size());
  int compared = 0;
  for (int y = 4; y < 76; ++y)
    for (int x = 4; x < 116; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        difference += std::pow(double(shown.at(x, y, c)) - double(there.at(x, y, c)), 2);
        contrast += std::pow(double(there.at(x, y, c)) - mean, 2), ++compared;
      }
  EXPECT_NEAR(mean_shown, mean, 0.02 * mean);
  EXPECT_LT(std::sqrt(difference / contrast), 0.2);  // edges by bilinear interpolation of pixels
  // The mirror image is none of it, and a camera at another place shows another picture.
  const Image moved = rendered(camera(perspective(0.15, half_cell), display), "moved");
  double other = 0;
  for (int y = 4; y < 76; ++y)
    for (int x = 4; x < 116; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        other += std::pow(double(moved.at(x, y, c)) - double(there.at(x, y, c)), 2);
  EXPECT_GT(other, 3 * difference);
  // Beyond the cells there is no light; behind the display neither.
  const Image outside = rendered(camera(perspective(0.5, 0), display), "outside");
  double light = 0;
  for (const float v : outside.pixels) light += double(v);
  EXPECT_EQ(light, 0);
  const auto fails = [&](const std::string& scene, const std::string& words) {
    folder.write("bad.xml", scene);
    const ProgramEnd e = run_program(folder.path, {"render", "bad.xml", "-o", "bad.exr"});
    EXPECT_EQ(e.exit_code, 2) << e.output;
    EXPECT_NE(e.output.find(words), std::string::npos) << e.output;
  };
  fails(
      camera(
          perspective(0, 0),
          "<shape type='sphere'><emitter type='lightfielddisplay'><string name='filename' value='field.exr'/>"
          "</emitter></shape></scene>"),
      "must be flat");
  fails(
      camera(
          perspective(0, 0),
          "<shape type='rectangle'><emitter type='lightfielddisplay'><string name='filename' value='view.exr'/>"
          "</emitter></shape></scene>"),
      "is no light field");
}

}  // namespace
}  // namespace aureole::test
