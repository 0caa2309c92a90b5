// SPDX-License-Identifier: Apache-2.0
// Cameras that measure the irradiance on their film, and lenses by their elements, in scenes whose pictures are known.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/render/job.h"
#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

LoadedScene lens_scene(const std::string& content, const std::string& integrator = "path") {
  return load_scene_from_string(
      "<scene version='3.0.0'><integrator type='" + integrator + "'/>" + content + "</scene>", "camera.xml",
      {});
}
Image lens_picture(const std::string& content, std::int64_t samples, const std::string& integrator = "path") {
  RenderOptions options;
  options.end = samples;
  RenderJob job(lens_scene(content, integrator), options);
  job.run(std::atomic<bool>(false));
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state().picture();
}
std::string lens_problem(const std::string& content, const std::string& integrator = "path") {
  try {
    RenderJob job(lens_scene(content, integrator), {});
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
std::string film_of(const std::string& quantity, int width, int height) {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(width) +
         "'/><integer name='height' value='" + std::to_string(height) + "'/><string name='quantity' value='" +
         quantity + "'/><rfilter type='box'/></film>";
}
std::string lens_camera(const std::string& file, const std::string& more, const std::string& film) {
  return "<sensor type='lens'><string name='filename' value='" +
         (source_dir() / "tests/references/scenes/lenses" / file).string() + "'/>" + more + film +
         "</sensor>";
}
std::string number(const std::string& name, double value) {
  return "<float name='" + name + "' value='" + std::to_string(value) + "'/>";
}
std::string word(const std::string& name, const std::string& value) {
  return "<string name='" + name + "' value='" + value + "'/>";
}
const std::string kSky = "<emitter type='constant'><string name='amount' value='1000 cd/m^2'/></emitter>";

TEST(FilmIrradiance, OfAPinholeByItsApertureLaw) {
  const auto camera = [](const std::string& more) {
    return "<sensor type='perspective'>" + word("measure", "irradiance") + number("fov", 90) +
           number("f_number", 2) + more + film_of("illuminance", 3, 1) + "</sensor>" + kSky;
  };
  const Image sine = lens_picture(camera(""), 64), thin = lens_picture(camera(word("aperture", "thin")), 64);
  // The middle pixel reaches to a third of the tangent: the mean of cos^4 over it, 1/(1 + x^2 + y^2)^2.
  double cos4 = 0, corner = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double x = (2 * (i + 0.5) / kSteps - 1) / 3, y = (2 * (j + 0.5) / kSteps - 1) / 3;
      cos4 += std::pow(1 + x * x + y * y, -2) / (kSteps * kSteps);
      corner += std::pow(1 + (x + 2 / 3.0) * (x + 2 / 3.0) + y * y, -2) / (kSteps * kSteps);
    }
  EXPECT_NEAR(double(sine.pixels[1]), 1000 * M_PI / 16 * cos4, 0.5);
  EXPECT_NEAR(double(thin.pixels[1]), 1000 * M_PI / 17 * cos4, 0.5);
  EXPECT_NEAR(double(sine.pixels[2]), 1000 * M_PI / 16 * corner, 0.5);
}

TEST(FilmIrradiance, LightPathsAgree) {
  const std::string scene =
      "<sensor type='thinlens'><transform name='to_world'><lookat origin='0, 0, -4' target='0, 0, 0' up='0, 1, 0'/></transform>" +
      word("measure", "irradiance") + number("fov", 50) + number("f_number", 1.4) +
      number("aperture_radius", 0.2) + number("focus_distance", 3) + film_of("illuminance", 1, 1) +
      "</sensor><shape type='sphere'/><emitter type='point'><point name='position' x='2' y='3' z='-4'/>"
      "<string name='amount' value='100 cd'/></emitter>";
  const double path = double(lens_picture(scene, 40000).pixels[0]);
  EXPECT_NEAR(double(lens_picture(scene, 40000, "ptracer").pixels[0]), path, 0.02 * path);
  EXPECT_NEAR(double(lens_picture(scene, 40000, "bdpt").pixels[0]), path, 0.02 * path);
}

TEST(LensSensor, SeesAUniformSkyAsItsApertureSays) {
  // A corrected lens meets the sine condition: pi L/(4 N^2) on the axis, of a small film.
  const std::string tiny = number("film_diagonal", 1), ideal = word("coating", "ideal");
  const auto value = [&](const std::string& file, const std::string& more, const char* quantity) {
    return double(
        lens_picture(lens_camera(file, tiny + more, film_of(quantity, 1, 1)) + kSky, 16384).pixels[0]);
  };
  const std::string irradiance = word("measure", "irradiance");
  EXPECT_NEAR(value("triplet.lens", irradiance + ideal + number("f_number", 8), "illuminance"),
              1000 * M_PI / (4 * 64), 0.12);
  EXPECT_NEAR(value("double_gauss.lens", irradiance + ideal + number("f_number", 4), "illuminance"),
              1000 * M_PI / 64, 0.5);
  // The radiance of the sky, whatever the stop.
  for (const double stop : {5.6, 16.0})
    EXPECT_NEAR(value("triplet.lens", ideal + number("f_number", stop), "luminance"), 1000, 8) << stop;
  // Six uncoated surfaces at nearly normal incidence: (4 n/(n + 1)^2)^2 for each element.
  const double t = std::pow(4 * 1.6204 / std::pow(2.6204, 2), 6);
  EXPECT_NEAR(value("triplet.lens", number("f_number", 16), "luminance"), 1000 * t, 10);
  EXPECT_GT(value("triplet.lens", word("coating", "mgf2") + number("f_number", 16), "luminance"),
            1000 * std::pow(0.98, 6));
}

TEST(LensSensor, DarkensTowardsTheCornersAsRaysOfDistantPointsSay) {
  // The irradiance of a distant sky is its luminance times the cross-section of the beam that the lens transmits, times the
  // solid angle for an area of the film: relative to the axis, the open fraction of the entrance pupil times cos^4.
  // `aureole lens` traces those beams from the object: the entrance pupil of the triplet at f/22 grows by 9.55 % at 17.87
  // degrees, 16.13 mm from the axis; of the double Gauss wide open 46.56 % are left at 20 degrees, 35.41 mm from it.
  const auto fall = [](const std::string& file, double stop, double height) {
    // The last of 41 pixels lies 20 pixels from the middle.
    const double diagonal = height / 20 * std::hypot(41, 1);
    const auto row =
        lens_picture(lens_camera(file,
                                 word("measure", "irradiance") + word("coating", "ideal") +
                                     number("film_diagonal", diagonal) + number("f_number", stop),
                                 film_of("illuminance", 41, 1)) +
                         kSky,
                     8192)
            .pixels;
    EXPECT_NEAR(double(row[0] / row[40]), 1, 0.03);
    return double(row[0] + row[40]) / (2 * double(row[20]));
  };
  const double small = 1.0955 * std::pow(std::cos(17.87 * M_PI / 180), 4);
  // The double Gauss has a distortion of D = 35.41/(100.034 tan(20 degrees)) - 1, which grows with the square of the height: a
  // solid angle takes (1 + D)(1 + 3 D) of the area that it takes without.
  const double distortion = 35.41 / (100.034 * std::tan(20 * M_PI / 180)) - 1,
               open = 0.4656 * std::pow(std::cos(20 * M_PI / 180), 4) /
                      ((1 + distortion) * (1 + 3 * distortion));
  EXPECT_NEAR(fall("triplet.lens", 22, 16.13), small, 0.02 * small);
  EXPECT_NEAR(fall("double_gauss.lens", 3.11, 35.41), open, 0.04 * open);
}

/// A picture of a small luminous sphere by a lens and by a pinhole camera with the same field of view.
TEST(LensSensor, PicturesAreUprightAndOfItsFocalLength) {
  const std::string target =
      "<shape type='sphere'><point name='center' x='-20' y='12' z='100'/><float name='radius' value='1.5'/>"
      "<emitter type='area'><string name='amount' value='1000 cd/m^2'/></emitter></shape>";
  const double focal = 50.02;
  const std::string pinhole = "<sensor type='perspective'>" +
                              number("fov", 2 * std::atan(18 / focal) * 180 / M_PI) +
                              film_of("luminance", 90, 60) + "</sensor>";
  const std::string lens = lens_camera(
      "triplet.lens", number("focus_distance", 100) + word("coating", "ideal"), film_of("luminance", 90, 60));
  const auto centroid = [](const Image& p) {
    double sum = 0, x = 0, y = 0;
    for (int j = 0; j < p.height; ++j)
      for (int i = 0; i < p.width; ++i) {
        const double v = double(p.at(i, j, 0));
        sum += v, x += v * (i + 0.5), y += v * (j + 0.5);
      }
    return std::array<double, 3>{x / sum, y / sum, sum};
  };
  const auto a = centroid(lens_picture(lens + target, 512)), b = centroid(lens_picture(pinhole + target, 64));
  EXPECT_NEAR(a[0], b[0], 0.4);
  EXPECT_NEAR(a[1], b[1], 0.4);
  EXPECT_GT(b[0], 50);
  EXPECT_LT(b[1], 30);
}

TEST(LensSensor, FocusesWhereItIsTold) {
  // A small bright disc at 3 m, in focus and not: the circle of confusion of a thin lens of 50 mm at f/5.6 that is focused
  // at 1.5 m has the diameter f^2 (3 - 1.5)/(N 3 (1.5 - f)) in the picture.
  const std::string target =
      "<shape type='disk'><transform name='to_world'><scale value='0.0005'/><rotate x='1' angle='180'/><translate z='3'/></transform>"
      "<emitter type='area'><string name='amount' value='1000000 cd/m^2'/></emitter></shape>";
  const auto spread = [&](double distance) {
    const Image p =
        lens_picture(lens_camera("triplet.lens",
                                 number("focus_distance", distance) + number("film_diagonal", 1.4142136) +
                                     number("f_number", 5.6) + word("coating", "ideal"),
                                 film_of("luminance", 100, 100)) +
                         target,
                     1024);
    double sum = 0, squares = 0;
    for (int j = 0; j < 100; ++j)
      for (int i = 0; i < 100; ++i) {
        const double v = double(p.at(i, j, 0)), x = (i - 49.5) * 0.01, y = (j - 49.5) * 0.01;
        sum += v, squares += v * (x * x + y * y);
      }
    return std::sqrt(squares / sum);  // mm
  };
  EXPECT_LT(spread(3), 0.02);
  // The root mean square radius of a disc is its radius over sqrt(2).
  const double f = 0.05, confusion = 1000 * f * f * 1.5 / (5.6 * 3 * (1.5 - f));
  EXPECT_NEAR(spread(1.5), confusion / 2 / std::sqrt(2.0), 0.15 * confusion / 2 / std::sqrt(2.0));
}

TEST(LensSensor, MistakesAreNamed) {
  const auto has = [](const std::string& content, const std::string& words,
                      const std::string& integrator = "path") {
    SCOPED_TRACE(content + words);
    const std::string message = lens_problem(content + kSky, integrator);
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_NE(message.find("camera.xml:"), std::string::npos) << message;
  };
  const std::string film = film_of("luminance", 2, 2);
  EXPECT_EQ(lens_problem(lens_camera("triplet.lens", "", film) + kSky), "");
  has("<sensor type='lens'>" + film + "</sensor>", "filename");
  has(lens_camera("missing.lens", "", film), "missing.lens");
  has(lens_camera("triplet.lens", number("f_number", 2), film), "opens no wider");
  has(lens_camera("triplet.lens", number("focus_distance", 0.02), film), "focal point");
  has(lens_camera("triplet.lens", "<integer name='blades' value='2'/>", film), "3 blades");
  has(lens_camera("triplet.lens", word("measure", "irradiance"), film), "quantity");
  has(lens_camera("triplet.lens", "", film), "ptracer", "ptracer");
  has("<sensor type='perspective'>" + word("measure", "irradiance") + number("f_number", 0.3) + "</sensor>",
      "0.5");
  TemporaryFolder folder;
  const std::string opaque = folder.write("opaque.lens", "50 5 bk7 20 stop\n-50 45 air 0.000001\n").string();
  has("<sensor type='lens'>" + word("filename", opaque) + number("focus_distance", 2) + film + "</sensor>",
      "no light passes");
  const std::string diverging = folder.write("diverging.lens", "-50 5 bk7 20 stop\n50 45 air 20\n").string();
  has("<sensor type='lens'>" + word("filename", diverging) + film + "</sensor>", "makes no picture");
}

}  // namespace
}  // namespace aureole::test
