// SPDX-License-Identifier: Apache-2.0
// Baked splats beside the scene they were baked from, from a camera that the bake does not know; and files that are written.
#include "aureole/instrument/splat_bake.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/parameter/splat/splat_writer.h"
#include "aureole/render/job.h"
#include "harness/paths.h"
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

std::string view_from(const char* origin) {
  return fmt::format(R"(<sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="{}" target="0, 0.5, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="64"/></sampler></sensor>)",
                     origin, kSide, kSide);
}

/// A room with a back wall that fills the picture, and a ball.
std::string room(const std::string& ball) {
  return R"(<emitter type="constant"><rgb name="radiance" value="0.5, 0.5, 0.5"/></emitter>
    <emitter type="point"><point name="position" x="2" y="4" z="3"/><rgb name="intensity" value="6, 6, 6"/></emitter>
    <shape type="rectangle"><transform name="to_world"><scale value="6"/><rotate x="1" angle="-90"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><scale value="6"/><translate z="-2"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.3, 0.45, 0.6"/></bsdf></shape>
    <shape type="sphere"><point name="center" x="0" y="0.6" z="0"/><float name="radius" value="0.6"/>)" +
         ball + "</shape>";
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

double held_out_psnr(const std::string& ball, const SplatBakeOptions& options, const SplatFolder& folder) {
  const std::string content = room(ball), held_out = view_from("1.2, 1.6, 3.4");
  const auto load = [](const std::string& text) {
    return load_scene_from_string(R"(<scene version="3.0.0">)" + text + "</scene>", "bake.xml");
  };
  const SplatBake baked =
      bake_splats(load(R"(<integrator type="path"/>)" + view_from("0, 1, 4") + content), options);
  const auto file = folder.path() / "baked.ply";
  write_splat_file(file, baked.cloud);
  const auto truth = picture_of(load(R"(<integrator type="path"/>)" + held_out + content), 256);
  const auto splats = picture_of(
      load(R"(<integrator type="splat"/>)" + held_out +
           R"(<shape type="cube"><transform name="to_world"><scale value="9"/></transform><bsdf type="null"/>
      <medium type="splats" name="interior"><string name="filename" value=")" +
           file.string() + R"("/></medium></shape>)"),
      64);
  return psnr(truth, splats);
}

TEST(SplatBake, AMatteSceneFromAnotherCamera) {
  const SplatFolder folder;
  SplatBakeOptions options;
  options.count = 60000, options.paths = 32;
  const double found = held_out_psnr(
      R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.2, 0.15"/></bsdf>)", options, folder);
  RecordProperty("psnr_db", fmt::format("{:.2f}", found));
  EXPECT_GT(found, 30) << found;
}

TEST(SplatBake, DoesNotDependOnAnything) {
  const auto load = [] {
    return load_scene_from_string(R"(<scene version="3.0.0"><integrator type="path"/>)" +
                                      view_from("0, 1, 4") + room(R"(<bsdf type="diffuse"/>)") + "</scene>",
                                  "bake.xml");
  };
  SplatBakeOptions options;
  options.count = 300, options.paths = 16, options.degree = 2;
  const SplatCloud a = bake_splats(load(), options).cloud, b = bake_splats(load(), options).cloud;
  EXPECT_TRUE(std::equal(a.harmonics.begin(), a.harmonics.end(), b.harmonics.begin(), b.harmonics.end()));
  EXPECT_EQ(a.degree, 2);
  options.as_points = true;
  const SplatCloud points = bake_splats(load(), options).cloud;
  EXPECT_EQ(points.degree, 0);
  EXPECT_EQ(points.scales[5].z, 0);
}

TEST(SplatBake, AnEmitterKeepsItsColour) {
  const auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="path"/>)" + view_from("0, 1, 4") +
          R"(<shape type="rectangle"><bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="0.4, 0.25, 0.6"/></emitter></shape></scene>)",
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
      EXPECT_EQ(notes.size(), extension == ".ply" ? 0u : 1u) << extension << notes.front();
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
