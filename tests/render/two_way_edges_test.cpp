// SPDX-License-Identifier: Apache-2.0
// Light around edges by paths from both ends: `path`, `ptracer` and `bdpt` find the same light, single techniques of `bdpt`
// find what the others find, and `bdpt` finds edges and lamps that only one of the two others does.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "aureole/render/plan.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/rendered.h"
#include "loading/load_text.h"
#include "render/edge_scenes.h"

namespace aureole::test {
namespace {

struct Mean {
  double value = 0, error = 0;
  testing::Picture picture{};
};

struct Settings {
  int depth = 5;
  bool diffraction = true;
  std::string parameters{};
  int fov = 22;
  int beam = 4;  ///< wavelengths
};

/// The luminance of the whole picture, of `samples` samples per pixel.
Mean luminance(const std::string& scene, const std::string& integrator, int samples,
               const Settings& settings = {}) {
  const std::string depth =
      integrator == "direct" ? "" : fmt::format(R"(<integer name="max_depth" value="{}"/>)", settings.depth);
  const std::string text = fmt::format(
      R"(<string name="length_unit" value="20um"/>
  <integrator type="{}">{}<boolean name="diffraction" value="{}"/>
    <string name="diffraction_model" value="beams"/><string name="beam_width" value="{} wavelengths"/>{}</integrator>
  <sensor type="perspective"><float name="fov" value="{}"/>
    <transform name="to_world"><lookat origin="0, -3.9, -0.4" target="0, 0, -0.4" up="0, 0, 1"/></transform>
    <sampler type="independent"><integer name="sample_count" value="{}"/></sampler>
    <film type="hdrfilm"><integer name="width" value="6"/><integer name="height" value="6"/><rfilter type="box"/></film>
  </sensor>{})",
      integrator, depth, settings.diffraction ? "true" : "false", settings.beam, settings.parameters,
      settings.fov, kSanitized ? 2 : samples, scene);
  RenderOptions options;
  options.replicates = 16;
  std::uint64_t seed = 0;
  for (const char c : integrator + settings.parameters) seed = 31 * seed + std::uint64_t(c);
  options.seed = seed;
  const testing::Picture p = testing::render(
      load_scene_from_string("<scene version=\"3.0.0\">" + text + "</scene>", "edges.xml"), options);
  return {p.all, p.all_error, p};
}

/// A light that emits downwards.
std::string lamp(double half, double x, double z) {
  return rectangle(
      fmt::format(R"(<scale value="{}"/><rotate x="1" angle="180"/><translate x="{}" z="{}"/>)", half, x, z),
      R"(<bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="3, 2, 1"/></emitter>)");
}
/// A sheet from x0 to x1 above the floor.
std::string sheet(double x0, double x1, double reflectance = 0.5) {
  return rectangle(
      fmt::format(R"(<scale x="{}" y="0.6"/><translate x="{}" z="0.2"/>)", (x1 - x0) / 2, (x0 + x1) / 2),
      grey(reflectance));
}
std::string half_plane() { return walls() + sheet(-1, 0) + lamp(0.1, -0.5, 0.95); }
std::string slit() { return walls() + sheet(-1, -0.05) + sheet(0.05, 1) + lamp(0.1, -0.5, 0.95); }
/// A plate like a star.
std::string star(const std::filesystem::path& folder) {
  std::ofstream mesh(folder / "star.obj");
  mesh << "v 0 0 0\n";
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? 0.5 : 0.2, a = std::numbers::pi * i / 5;
    mesh << fmt::format("v {} {} 0\n", r * std::cos(a), r * std::sin(a));
  }
  for (int i = 0; i < 10; ++i) mesh << fmt::format("f 1 {} {}\n", 2 + i, 2 + (i + 1) % 10);
  return walls() + lamp(0.1, -0.3, 0.95) + R"(<shape type="obj"><string name="filename" value=")" +
         (folder / "star.obj").string() +
         R"("/><transform name="to_world"><translate z="0.2"/></transform>)" + grey(0.5) + "</shape>";
}
/// Thin fog around everything.
std::string in_fog(const std::string& scene) {
  return scene +
         R"(<shape type="cube"><transform name="to_world"><scale value="5"/></transform><bsdf type="null"/>
    <medium type="homogeneous" name="interior"><spectrum name="sigma_t" value="0.15"/><spectrum name="albedo" value="0.8"/></medium></shape>)";
}

void expect_equal(const char* name, const Mean& a, const Mean& b, double precision) {
  if (kSanitized) return;
  const double error = std::hypot(a.error, b.error);
  std::printf("  %s: %.6g +- %.2g and %.6g +- %.2g, z %+.2f\n", name, a.value, a.error, b.value, b.error,
              (b.value - a.value) / error);
  EXPECT_NEAR(a.value, b.value, 4 * error) << name;
  EXPECT_LT(error, precision * a.value) << name;
}

void expect_equal_from_both_ends(const std::string& scene, const Settings& settings = {}, int usual = 64) {
  const int n = effort(usual, 1024);
  const Mean path = luminance(scene, "path", n, settings), light = luminance(scene, "ptracer", n, settings),
             both = luminance(scene, "bdpt", n / 2, settings);
  Settings without = settings;
  without.diffraction = false;
  const Mean off = luminance(scene, "path", n / 2, without);
  std::printf("  without diffraction %.6g +- %.2g\n", off.value, off.error);
  expect_equal("path, bdpt", path, both, 0.03);
  expect_equal("ptracer, bdpt", light, both, 0.06);
  if (kSanitized) return;
  EXPECT_GT(testing::largest_difference(both.picture, off.picture), 6)
      << "there is no diffracted light to compare";
}

TEST(TwoWayEdges, HalfPlane) { expect_equal_from_both_ends(half_plane()); }
TEST(TwoWayEdges, Slit) { expect_equal_from_both_ends(slit()); }
TEST(TwoWayEdges, Star) {
  const TemporaryFolder folder;
  expect_equal_from_both_ends(star(folder.path), {}, 256);
}
TEST(TwoWayEdges, InFog) { expect_equal_from_both_ends(in_fog(half_plane()), {.depth = 4}); }

// Paths of light do not come through the pane before the sensor.
TEST(TwoWayEdges, BehindGlass) {
  const std::string scene =
      half_plane() + R"(<shape type="cube"><transform name="to_world"><scale x="1" y="0.05" z="0.8"/>
    <translate y="-2.5" z="-0.4"/></transform><bsdf type="dielectric"/></shape>)";
  const int n = effort(256, 1024);
  const Settings settings{.depth = 5};
  const Mean path = luminance(scene, "path", n, settings), both = luminance(scene, "bdpt", n / 2, settings),
             off = luminance(scene, "bdpt", n / 2, {.depth = 5, .diffraction = false});
  std::printf("  without diffraction %.6g +- %.2g\n", off.value, off.error);
  expect_equal("path, bdpt", path, both, 0.05);
  if (kSanitized) return;
  EXPECT_GT(testing::largest_difference(both.picture, off.picture), 6);
}

/// Below the sheet, in the shadow, a plate sends the light of the edge under a black shield to a wall, which alone the sensor sees.
std::string plate_in_the_shadow(const std::string& bsdf) {
  return only_edges() + point("-.5, -.4, .95") +
         rectangle(R"(<scale x="1.5" y="0.55"/><translate y="0.45" z="-0.3"/>)", grey(0)) +
         rectangle(R"(<scale y="0.3"/><rotate x="1" angle="90"/><translate y="0.9" z="-0.7"/>)", grey(0.8)) +
         rectangle(
             R"(<scale value="0.3"/><rotate x="1" angle="-45"/><translate x="0.25" y="-0.4" z="-0.75"/>)",
             bsdf);
}

TEST(TwoWayEdges, LightOfEdgesThatAMirrorReflectsIsFoundFromTheLamp) {
  const std::string scene =
      plate_in_the_shadow(R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)");
  const int n = effort(1024, 4096);
  const Settings settings{.depth = 4, .fov = 14, .beam = 1};
  const Mean path = luminance(scene, "path", n, settings), light = luminance(scene, "ptracer", n, settings),
             both = luminance(scene, "bdpt", n / 2, settings);
  expect_equal("ptracer, bdpt", light, both, 0.12);
  std::printf("  path %.6g +- %.2g\n", path.value, path.error);
  if (kSanitized) return;
  EXPECT_GT(both.value - path.value, 4 * std::hypot(both.error, path.error));
}

// Behind an edge light meets a plate with a mirror's lobe and a diffuse one, of which each end finds one, and on its way to the edge, a
// small plate over the lamp.
TEST(TwoWayEdges, LightOfEdgesThatAPolishedPlateReflects) {
  const std::string scene =
      plate_in_the_shadow(R"(<bsdf type="plastic"><float name="int_ior" value="2.5"/></bsdf>)") +
      rectangle(R"(<scale value="0.1"/><rotate x="1" angle="180"/><translate x="-0.5" y="-0.4" z="1"/>)",
                grey(0.9));
  const int n = effort(2048, 32768);
  const Settings settings{.depth = 6, .fov = 14, .beam = 1};
  Settings without = settings;
  without.diffraction = false;
  const Mean light = luminance(scene, "ptracer", n, settings),
             both = luminance(scene, "bdpt", n / 2, settings), off = luminance(scene, "bdpt", n / 2, without);
  expect_equal("ptracer, bdpt", light, both, 0.3);
  std::printf("  without diffraction %.6g +- %.2g\n", off.value, off.error);
  if (kSanitized) return;
  EXPECT_GT(testing::largest_difference(both.picture, off.picture), 5);
}

// All light in this scene comes to a wall from lamps, straight and around one edge.
TEST(DirectEdges, AreThoseOfThePathTracer) {
  const std::string scene =
      only_edges() + point("-.5, -.4, .95") +
      rectangle(R"(<scale y="0.3"/><rotate x="1" angle="90"/><translate y="0.9" z="-0.7"/>)", grey(0.8));
  const int n = effort(64, 1024);
  const Settings settings{.depth = 3, .fov = 14};
  const Mean direct = luminance(scene, "direct", n, settings), path = luminance(scene, "path", n, settings),
             off = luminance(scene, "path", n, {.depth = 3, .diffraction = false, .fov = 14});
  expect_equal("path, direct", path, direct, 0.05);
  if (kSanitized) return;
  EXPECT_GT(direct.value - off.value, 4 * std::hypot(direct.error, off.error));
}

// A light that emits upwards: the edges have light of the ceiling only.
TEST(TwoWayEdges, SingleTechniquesFindTheSame) {
  const std::string scene =
      rectangle(R"(<translate z="-1"/>)", grey(0.7)) + only_edges() +
      rectangle(R"(<rotate x="1" angle="180"/><translate x="-0.4" z="0.95"/>)", grey(0.8)) +
      rectangle(
          R"(<scale value="0.2"/><translate x="-0.4" z="0.5"/>)",
          R"(<bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="3, 2, 1"/></emitter>)");
  const auto only = [&](int s, int t, bool diffraction, int samples) {
    return luminance(
        scene, "bdpt", samples,
        {.depth = 4,
         .diffraction = diffraction,
         .parameters = fmt::format(
             R"(<integer name="strategy_s" value="{}"/><integer name="strategy_t" value="{}"/>)", s, t),
         .beam = 1});
  };
  const int n = effort(1024, 4096);
  const Mean reference = only(1, 4, true, n), off = only(1, 4, false, n);
  std::printf("  without diffraction %.6g +- %.2g\n", off.value, off.error);
  expect_equal("s = 2", reference, only(2, 3, true, n), 0.1);
  if (kSanitized) return;
  EXPECT_GT(reference.value - off.value, 4 * std::hypot(reference.error, off.error));
}

}  // namespace
}  // namespace aureole::test
