// SPDX-License-Identifier: Apache-2.0
// Baked splats and grids beside the scene they were baked from, from cameras that the bake does not know; and files that are
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/instrument/bake/radiance_bake.h"
#include "aureole/instrument/bake/splat_bake.h"
#include "aureole/medium/radiance/grid_radiance.h"
#include "aureole/parameter/splat/splat_writer.h"
#include "aureole/render/job.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

constexpr int kSide = 64;

/// Linear sRGB of a picture, row by row.
std::vector<double> picture_of(const LoadedScene& scene, int spp) {
  RenderOptions options;
  options.threads = 2, options.end = spp;
  RenderJob job(scene, options);
  EXPECT_EQ(job.run(std::atomic<bool>(false)), RenderJob::Outcome::finished);
  std::vector<double> all;
  const Film& film = scene.scene->film();
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      double channels[16], alpha;
      float rgb[3];
      job.state().films[0].mean(x, y, channels, &alpha);
      film.develop_rgb(channels, rgb);
      all.insert(all.end(), rgb, rgb + 3);
    }
  return all;
}

std::filesystem::path bake_scenes() { return source_dir() / "scenes/splats"; }

/// scenes/splats/bake_room.xml, with a ball that is matte or glossy.
LoadedScene room(const std::string& ball, const std::string& origin = "0, 1, 4") {
  LoadOptions load;
  load.defines = {{"ball", ball},
                  {"origin", origin},
                  {"width", std::to_string(kSide)},
                  {"height", std::to_string(kSide)}};
  return load_scene(bake_scenes() / "bake_room.xml", load);
}

double psnr(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d =
        double(srgb_encode(float(std::max(0., a[i])))) - double(srgb_encode(float(std::max(0., b[i]))));
    sum += d * d;
  }
  return -10 * std::log10(sum / double(a.size()));
}

/// The smallest PSNR over cameras that the bake does not know, of an integrator that shows a medium.
double held_out_psnr(const std::string& ball, const std::string& integrator, const std::string& medium) {
  double least = 1000;
  for (const char* origin : {"1.2, 1.6, 3.4", "-2, 1.1, 2.6", "0.3, 2.6, 2.8"}) {
    LoadOptions load;
    const auto view = [&] {
      std::string text = file_content(bake_scenes() / "bake_view.xml");
      for (const auto& [name, value] : {std::pair<std::string, std::string>{"$origin", origin},
                                        {"$width", std::to_string(kSide)},
                                        {"$height", std::to_string(kSide)},
                                        {"$spp", "64"}})
        text.replace(text.find("=\"" + name + "\"") + 2, name.size(), value);
      const std::size_t begin = text.find("<sensor");
      return text.substr(begin, text.rfind("</scene>") - begin);
    };
    const auto truth = picture_of(room(ball, origin), 256);
    const auto shown = picture_of(
        load_scene_from_string(
            R"(<scene version="3.0.0">)" + integrator + view() +
                R"(<shape type="cube"><transform name="to_world"><scale value="9"/></transform><bsdf type="null"/>)" +
                medium + "</shape></scene>",
            "bake.xml"),
        64);
    const double found = psnr(truth, shown);
    ::testing::Test::RecordProperty(fmt::format("psnr_db_{}", origin), fmt::format("{:.2f}", found));
    least = std::min(least, found);
  }
  return least;
}

/// The splats are blended at each sample's own place, without dilation: baked splats cover their surface.
const char* const kShown =
    R"(<integrator type="splat"><float name="dilation" value="0"/><string name="evaluated_at" value="sample"/></integrator>)";

std::string splats_in(const std::filesystem::path& file) {
  return R"(<medium type="splats" name="interior"><string name="filename" value=")" + file.string() +
         R"("/></medium>)";
}

TEST(SplatBake, AMatteSceneFromOtherCameras) {
  const SplatFolder folder;
  SplatBakeOptions options;
  options.count = 60000, options.paths = 32;
  const auto file = folder.path() / "baked.ply";
  write_splat_file(file, bake_splats(room("matte"), options).cloud);
  EXPECT_GT(held_out_psnr("matte", kShown, splats_in(file)), 35);
}

TEST(SplatBake, AGlossySceneFromOtherCameras) {
  const SplatFolder folder;
  SplatBakeOptions options;
  options.count = 60000, options.paths = 128, options.degree = 3;
  const auto file = folder.path() / "baked.ply";
  write_splat_file(file, bake_splats(room("glossy"), options).cloud);
  EXPECT_GT(held_out_psnr("glossy", kShown, splats_in(file)), 30);
}

TEST(RadianceBake, ScenesFromOtherCameras) {
  const SplatFolder folder;
  const auto file = folder.path() / "baked.npz";
  for (const int degree : {0, 3}) {
    const std::string ball = degree > 0 ? "glossy" : "matte";
    RadianceBakeOptions options;
    options.resolution = 256, options.paths = degree > 0 ? 128 : 32, options.degree = degree;
    const RadianceBake baked = bake_radiance_grid(room(ball), options);
    EXPECT_NEAR(baked.area, 2 * 144 + 4 * M_PI * 0.36, 0.01);
    write_radiance_voxels(file, baked.voxels);
    const double found =
        held_out_psnr(ball, R"(<integrator type="radiance_field"/>)",
                      R"(<medium type="radiance_grid" name="interior"><string name="filename" value=")" +
                          file.string() + R"("/></medium>)");
    EXPECT_GT(found, 25) << degree;
  }
}

TEST(RadianceBake, AWallIsOpaqueWhereItIs) {
  // A plane through the middle of voxels: its colour, and the place where half of the light is lost.
  const auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/>
      <shape type="rectangle"><bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="0.4, 0.25, 0.6"/></emitter></shape></scene>)",
      "bake.xml");
  RadianceBakeOptions options;
  options.resolution = 20, options.paths = 256, options.degree = 1;
  const RadianceBake baked = bake_radiance_grid(scene, options);
  const RadianceVoxels& g = baked.voxels;
  EXPECT_EQ(g.size, (std::array<int, 3>{25, 25, 5}));
  EXPECT_EQ(baked.occupied, 441u);  // 21 x 21
  const float expected[3] = {0.4f, 0.25f, 0.6f};
  std::size_t dense = 0;
  for (std::size_t i = 0; i < g.stored(); ++i) {
    dense += g.densities[i] > 0;
    // Seen along -z, from the side that emits.
    const float* h = g.harmonics_of(i);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(0.5f + 0.28209479f * h[k] - 0.48860251f * h[6 + k], srgb_encode(expected[k]), 0.03f) << i;
  }
  EXPECT_EQ(dense, baked.occupied);
  EXPECT_EQ(g.stored(), 23u * 23 * 3);
}

TEST(RadianceBake, TheThicknessOfAWallDoesNotDependOnItsTurn) {
  RadianceBakeOptions options;
  options.resolution = 30, options.paths = 1;
  const struct {
    const char* text;
    Transform to_world;
  } turns[] = {{R"(<rotate x="1" angle="20"/><rotate y="1" angle="35"/>)",
                Transform::rotate(0, 1, 0, 35) * Transform::rotate(1, 0, 0, 20)},
               {R"(<rotate x="1" angle="45"/>)", Transform::rotate(1, 0, 0, 45)},
               {R"(<translate z="0.013"/>)", Transform::translate(0, 0, 0.013)}};
  for (const auto& [turn, to_world] : turns) {
    const auto scene = load_scene_from_string(
        fmt::format(
            R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/><emitter type="constant"/>
      <shape type="rectangle"><transform name="to_world">{}</transform><bsdf type="diffuse"/></shape></scene>)",
            turn),
        "bake.xml");
    const RadianceField field(
        std::make_shared<const RadianceVoxels>(bake_radiance_grid(scene, options).voxels), Transform(), 1);
    const Vec3 normal = normalize(to_world.vector({0, 0, 1}));
    double sum = 0;
    constexpr int kRays = 81, kSteps = 600;
    for (int i = 0; i < kRays; ++i) {
      const Vec3 p = to_world.point({0.17f * float(i % 9 - 4), 0.17f * float(i / 9 - 4), 0});
      double thickness = 0;
      for (int k = 0; k < kSteps; ++k) {
        const float t = 0.4f * ((float(k) + 0.5f) / kSteps - 0.5f);
        thickness += double(field.density(field.index_of(p + normal * t))) * 0.4 / kSteps;
      }
      EXPECT_NEAR(thickness, 5, 2) << turn << " " << i;
      sum += thickness / kRays;
    }
    EXPECT_NEAR(sum, 5, 0.15) << turn;
  }
}

TEST(SplatBake, DensityByTheDistanceFromTheCamera) {
  // A plane below the camera: splats per area fall with the square of the distance, and their radii grow with it.
  const auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><transform name="to_world">
      <lookat origin="0, 0, 1" target="1, 0, 0.5" up="0, 0, 1"/></transform></sensor>
      <shape type="rectangle"><transform name="to_world"><scale value="10"/></transform><bsdf type="diffuse"/></shape></scene>)",
      "bake.xml");
  SplatBakeOptions options;
  options.count = 40000, options.paths = 1, options.density = SurfaceLight::Density::camera;
  const SplatCloud cloud = bake_splats(scene, options).cloud;
  // Over the disc of radius r the integral of 1 / (1 + x^2) is pi ln(1 + r^2); over the square by the midpoint rule.
  double whole = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const double x = 20. * (i % kSteps + 0.5) / kSteps - 10, y = 20. * (i / kSteps + 0.5) / kSteps - 10;
    whole += 400. / (kSteps * kSteps) / (1 + x * x + y * y);
  }
  int inside = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double d2 = 1 + double(cloud.positions[i].x) * double(cloud.positions[i].x) +
                      double(cloud.positions[i].y) * double(cloud.positions[i].y);
    inside += d2 < 1 + 9;
    const double spacing = std::sqrt(whole * d2 / double(cloud.size()));
    ASSERT_NEAR(double(cloud.scales[i].x) / (0.6 * spacing), 1, 0.25) << d2;
  }
  EXPECT_NEAR(inside / 40000., M_PI * std::log(10.) / whole, 0.01);
}

TEST(SplatBake, DoesNotDependOnAnything) {
  SplatBakeOptions options;
  options.count = 300, options.paths = 16, options.degree = 2;
  const SplatCloud a = bake_splats(room("matte"), options).cloud,
                   b = bake_splats(room("matte"), options).cloud;
  EXPECT_TRUE(std::equal(a.harmonics.begin(), a.harmonics.end(), b.harmonics.begin(), b.harmonics.end()));
  EXPECT_EQ(a.degree, 2);
  options.as_points = true;
  const SplatCloud points = bake_splats(room("matte"), options).cloud;
  EXPECT_EQ(points.degree, 0);
  EXPECT_EQ(points.scales[5].z, 0);
  RadianceBakeOptions grid;
  grid.resolution = 16, grid.paths = 8;
  EXPECT_EQ(bake_radiance_grid(room("matte"), grid).voxels.harmonics,
            bake_radiance_grid(room("matte"), grid).voxels.harmonics);
}

TEST(SplatBake, AnEmitterKeepsItsColour) {
  const auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/>
          <shape type="rectangle"><bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="0.4, 0.25, 0.6"/></emitter></shape></scene>)",
      "bake.xml");
  SplatBakeOptions options;
  options.count = 50, options.paths = 256;
  const SplatBake baked = bake_splats(scene, options);
  EXPECT_NEAR(baked.area, 4, 1e-5);
  const float expected[3] = {0.4f, 0.25f, 0.6f};
  for (std::size_t i = 0; i < 50; ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(0.5f + 0.28209479f * baked.cloud.harmonics_of(i)[k], srgb_encode(expected[k]), 0.03f) << i;
}

TEST(SplatBake, WrittenFilesAreReadAgain) {
  const SplatFolder folder;
  for (const char* name : {"sh0.ply", "sh3.ply"}) {
    const SplatCloud from = read_splat_file(source_dir() / "tests/medium/data/splats" / name);
    for (const std::string& extension : splat_extensions()) {
      const auto file = folder.path() / ("out" + extension);
      const auto notes = write_splat_file(file, from);
      const SplatCloud to = read_splat_file(file);
      ASSERT_EQ(to.size(), from.size());
      ASSERT_EQ(to.degree, from.degree);
      const bool rounds = extension == ".spz";
      EXPECT_EQ(notes.size(), extension == ".ply" || extension == ".usda" ? 0u : 1u)
          << extension << notes.front();
      for (std::size_t i = 0; i < from.size(); ++i) {
        double turn = 0;
        for (std::size_t k = 0; k < 4; ++k) turn += double(from.rotations[i][k]) * double(to.rotations[i][k]);
        EXPECT_NEAR(std::abs(turn), 1, rounds ? 1e-5 : 1e-6);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(from.positions[i][k], to.positions[i][k], rounds ? 1.3e-4 : 1e-6);
          EXPECT_NEAR(from.scales[i][k], to.scales[i][k], from.scales[i][k] * (rounds ? 0.032f : 1e-6f));
        }
        EXPECT_NEAR(from.opacities[i], to.opacities[i], rounds ? 0.002 : 1e-6);
        for (std::size_t k = 0; k < 3 * from.coefficients(); ++k)
          EXPECT_NEAR(from.harmonics_of(i)[k], to.harmonics_of(i)[k],
                      rounds ? (k < 3 ? 0.0135 : 0.004) : 1e-6);
      }
    }
  }
  EXPECT_THROW(write_splat_file(folder.path() / "out.ksplat", SplatCloud()), Error);
}

}  // namespace
}  // namespace aureole::test
