// SPDX-License-Identifier: Apache-2.0
// Direct volume rendering, one ray at a time, against closed forms of the forms, methods and limits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "integrator/dvr_test_support.h"

namespace aureole::test {
namespace {

double slab(const VolumeFolder& folder, const std::string& parameters, double step,
            const std::string& medium = text("extinction", "0 2")) {
  const auto scene =
      scene_of(dvr(parameters + number("step", step)), volume_of(folder, "slab", {2, 2, 2}, kOnes, medium));
  const Seen seen = look(scene, kAlongZ);
  EXPECT_LT(seen.spread, 1e-5 * seen.radiance);
  return seen.radiance;
}

TEST(Dvr, SlabOfThickness2) {
  const VolumeFolder folder;
  const double exact = 1 - std::exp(-2.0);  // 0.864665
  const std::string exhaustive = number("termination", 0);
  for (const int n : {1, 3, 4, 16, 64}) EXPECT_NEAR(slab(folder, exhaustive, 1.0 / n), exact, 2e-6) << n;
  const std::string premultiplied = exhaustive + text("form", "premultiplied"),
                    taylor = exhaustive + text("alpha", "taylor");
  const std::pair<int, std::array<double, 2>> rows[] = {
      {4, {1.09877, 0.9375}}, {16, {0.91983, 0.881933}}, {64, {0.87825, 0.868916}}};
  for (const auto& [n, expected] : rows) {
    EXPECT_NEAR(slab(folder, premultiplied, 1.0 / n), expected[0], 1e-5) << n;
    EXPECT_NEAR(slab(folder, taylor, 1.0 / n), expected[1], 1e-5) << n;
  }
  EXPECT_NEAR(slab(folder, text("method", "emission_absorption"), 0.25), exact, 2e-6);
}

TEST(Dvr, TheLastStepIsShorter) {
  const VolumeFolder folder;
  EXPECT_NEAR(slab(folder, number("termination", 0), 0.3), 1 - std::exp(-2.0), 2e-6);
  EXPECT_NEAR(slab(folder, number("termination", 0), 17), 1 - std::exp(-2.0), 2e-6);
  // A premultiplied sum with steps of 0.4, 0.4 and 0.2.
  const double t = std::exp(-0.8);
  EXPECT_NEAR(slab(folder, number("termination", 0) + text("form", "premultiplied"), 0.4),
              0.8 + 0.8 * t + 0.4 * t * t, 1e-5);
}

TEST(Dvr, OpacityBelongsToALength) {
  const VolumeFolder folder;
  const auto content = volume_of(folder, "slab", {2, 2, 2}, kOnes,
                                 text("opacity", "0 0.3") + text("clip_box", "0 0 0 1 1 0.25"));
  EXPECT_NEAR(look(scene_of(dvr(""), content), kAlongZ).radiance, 0.0853088, 1e-6);
  EXPECT_NEAR(look(scene_of(dvr(""), content), kAlongZ).alpha, 0.0853088, 1e-6);
  const auto thin = volume_of(folder, "slab", {2, 2, 2}, kOnes,
                              text("opacity", "0 0.3") + number("opacity_unit_length", 0.5));
  EXPECT_NEAR(look(scene_of(dvr(""), thin), kAlongZ).radiance, 1 - 0.7 * 0.7, 1e-6);
}

TEST(Dvr, NarrowFunctionsNeedPreintegration) {
  const VolumeFolder folder;
  const auto content =
      volume_of(folder, "ramp", {64, 2, 2}, ramp(64), text("extinction", "0.45 0, 0.45 10, 0.55 10, 0.55 0"));
  const double found[] = {0, 0, 1.25, 0.9375};
  const int counts[] = {4, 8, 16, 64};
  for (int i = 0; i < 4; ++i) {
    const std::string measures = R"(<boolean name="measures" value="true"/>)" +
                                 number("step", 1.0 / counts[i]) + number("termination", 0);
    EXPECT_NEAR(look(scene_of(dvr(measures), content), kAlongX).measures[0], found[i], 1e-4) << counts[i];
    EXPECT_NEAR(
        look(scene_of(dvr(measures + text("classification", "preintegrated")), content), kAlongX).measures[0],
        1, 1e-4)
        << counts[i];
  }
}

TEST(Dvr, OrdersSkippingAndTermination) {
  const VolumeFolder folder;
  const std::string content = ball(
      folder, text("extinction", "0.3 0, 0.5 8, 1 2") + text("color_map", "viridis") + text("range", "0 1"));
  const auto render = [&](const std::string& parameters) {
    return look(scene_of(dvr(number("step", 0.01) + parameters), content), kOblique);
  };
  const Seen front = render(number("termination", 0));
  EXPECT_GT(front.radiance, 0.05);
  const Seen back = render(text("order", "back_to_front") + number("termination", 0));
  EXPECT_NEAR(back.radiance, front.radiance, 1e-6);
  EXPECT_NEAR(back.alpha, front.alpha, 1e-6);
  const Seen unskipped = render(number("termination", 0) + R"(<boolean name="skip_empty" value="false"/>)");
  EXPECT_EQ(unskipped.radiance, front.radiance);
  EXPECT_EQ(unskipped.alpha, front.alpha);
  const Seen early = render(number("termination", 0.4));
  EXPECT_LT(early.radiance, front.radiance);
  EXPECT_GT(early.radiance, front.radiance - 0.4);
}

TEST(Dvr, PremultipliedStepsConvergeWithFirstOrder) {
  const VolumeFolder folder;
  const std::string content = ball(folder, text("extinction", "0 0, 1 6"));
  const double exact =
      look(scene_of(dvr(text("method", "emission_absorption") + number("tolerance", 1e-5)), content),
           kOblique)
          .radiance;
  double last = 0;
  for (const double step : {0.04, 0.02, 0.01, 0.005}) {
    const double error =
        look(scene_of(dvr(text("form", "premultiplied") + number("termination", 0) + number("step", step)),
                      content),
             kOblique)
            .radiance -
        exact;
    if (last != 0) {
      EXPECT_NEAR(std::log2(last / error), 1, 0.05) << step;
    }
    last = error;
  }
}

TEST(Dvr, PathFindsTheSameLight) {
  const VolumeFolder folder;
  const std::string content = ball(folder, text("extinction", "0 0, 1 6"));
  const double exact = look(scene_of(dvr(text("method", "emission_absorption")), content), kOblique).radiance;
  const auto scene = scene_of(R"(path">)", content);
  const auto [mean, error] = mean_radiance(scene, kOblique, 4096);
  EXPECT_LT(error, 0.01 * exact);
  EXPECT_NEAR(mean, exact, 4 * error);
}

TEST(Dvr, SingleScatteringOfASlab) {
  const VolumeFolder folder;
  // Light from the side of the sensor: both ways have the same length.
  const std::string content =
      volume_of(folder, "slab", {2, 2, 2}, kOnes,
                text("extinction", "0 2") + text("colors", "0 0.6 0.6 0.6") + text("color_is", "albedo")) +
      R"(<emitter type="directional"><vector name="direction" x="0" y="0" z="1"/>
                                 <spectrum name="irradiance" value="3"/></emitter>)";
  const auto scene = scene_of(
      dvr(text("method", "single_scattering") + number("step", 0.05) + number("termination", 0)), content);
  const double exact = 0.6 * 3 / (4 * 3.14159265358979) * (1 - std::exp(-4.0)) / 2;
  const auto [mean, error] = mean_radiance(scene, kAlongZ, 512, true);
  EXPECT_LT(error, 0.01 * exact);
  EXPECT_NEAR(mean, exact, 4 * error + 2e-3 * exact);
}

// Noisy light of a sky is no reason to halve the steps; `path` finds the same light.
TEST(Dvr, SingleScatteringUnderASky) {
  const VolumeFolder folder;
  const std::string content = ball(folder, text("extinction", "0 0, 1 6") + text("color_is", "albedo"), 16) +
                              R"(<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>)";
  const std::string method = text("method", "single_scattering"),
                    measures = R"(<boolean name="measures" value="true"/>)";
  const auto steps = scene_of(dvr(method + measures), content),
             paths = scene_of(R"(path"><integer name="max_scattering" value="1"/>)", content);
  EXPECT_LE(look(steps, kOblique).measures[3], 64);  // at most the diagonal in steps of half a voxel
  const auto found = mean_radiance(steps, kOblique, 1024, true),
             expected = mean_radiance(paths, kOblique, 4096, true);
  EXPECT_LT(found.error, 0.01 * expected.mean);
  EXPECT_NEAR(found.mean, expected.mean, 4 * std::hypot(found.error, expected.error));
}

TEST(Dvr, Projections) {
  const VolumeFolder folder;
  const auto render = [&](const std::string& method) {
    const std::string content =
        volume_of(folder, "ramp", {64, 2, 2}, ramp(64),
                  text("opacity", "0 0, 1 0.5") + text("color_map", "gray") + text("range", "0 1"));
    return look(scene_of(dvr(text("method", method) + R"(<boolean name="measures" value="true"/>)"), content),
                kAlongX);
  };
  EXPECT_NEAR(render("average").measures[1], 0.5, 1e-5);
  EXPECT_NEAR(render("average").alpha, 0.25, 1e-3);
  EXPECT_NEAR(render("mip").measures[1], 1 - 0.5 / 64, 1e-6);
  EXPECT_NEAR(render("mip").measures[2], 2, 0.01);  // the ray begins 1 before the cube
  EXPECT_NEAR(slab(folder, text("method", "xray"), 0.1), std::exp(-2.0), 2e-6);
}

TEST(Dvr, AThinSlabIsItsSlice) {
  const VolumeFolder folder;
  std::vector<float> values;
  for (int i = 0; i < 8 * 8 * 8; ++i) values.push_back(std::sin(float(i) * 12.9f) * 0.5f + 0.5f);
  const auto content = volume_of(folder, "noise", {8, 8, 8}, values,
                                 text("extinction", "0 1") + text("clip_box", "0 0 0.3124 1 1 0.3126"));
  const auto scene =
      scene_of(dvr(text("method", "average") + R"(<boolean name="measures" value="true"/>)"), content);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const Ray ray{{(float(x) + 0.5f) / 8, (float(y) + 0.5f) / 8, -1}, {0, 0, 1}};
      EXPECT_NEAR(look(scene, ray).measures[1], values[std::size_t(2 * 64 + y * 8 + x)], 1e-3);
    }
}

TEST(Dvr, IsosurfacesOfADistance) {
  const VolumeFolder folder;
  // A window of 24^3 voxels on a sphere of a radius of 400 voxels around (12, 12, -380).
  constexpr int n = 24;
  std::vector<float> values;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        values.push_back(float(400 - std::sqrt(std::pow(x + 0.5 - 12, 2) + std::pow(y + 0.5 - 12, 2) +
                                               std::pow(z + 0.5 + 388, 2))));
  const std::string medium = text("opacity", "0 0.9999") + text("colors", "0 1 1 1") +
                             number("opacity_unit_length", 0.001) + number("ambient", 0) +
                             number("diffuse", 1) + number("specular", 0);
  const std::string light = R"(<emitter type="directional"><vector name="direction" x="0.6" y="0" z="-0.8"/>
                               <spectrum name="irradiance" value="3.14159265"/></emitter>)";
  const auto scene =
      scene_of(dvr(text("method", "isosurface") + text("isovalues", "0") + text("lighting", "gradient") +
                   R"(<boolean name="measures" value="true"/>)"),
               volume_of(folder, "distance", {n, n, n}, values, medium) + light);
  for (const auto& [x, y] : {std::pair{0.5f, 0.5f}, {0.31f, 0.62f}, {0.77f, 0.4f}, {0.43f, 0.29f}}) {
    const Vec3 o{x, y, 2}, d{0, 0, -1};
    const Seen seen = look(scene, {o, d}, 0, true);
    const double dx = double(x) * n - 12, dy = double(y) * n - 12,
                 z = std::sqrt(400.0 * 400 - dx * dx - dy * dy) - 388;
    EXPECT_NEAR((2 - double(seen.measures[2])) * n, z, 1e-3);
    // The light shows the normal: its cosine changes by more than 1e-3 over 0.1 degrees.
    const double nx = dx / 400, nz = (z + 388) / 400;
    EXPECT_NEAR(seen.radiance / 0.9999, -0.6 * nx + 0.8 * nz, 1e-3);
  }
}

TEST(Dvr, GradientShading) {
  const VolumeFolder folder;
  // Numbers grow along x: the normal is the x axis, 60 degrees from the light and 0 from the sensor.
  const std::string medium = text("extinction", "0 20") + text("colors", "0 0.5 0.5 0.5") +
                             number("ambient", 0) + number("diffuse", 0.7) + number("specular", 0.3) +
                             number("shininess", 4);
  const std::string light =
      R"(<emitter type="directional"><vector name="direction" x="0.5" y="0.8660254" z="0"/>
                               <spectrum name="irradiance" value="2"/></emitter>)";
  const auto content = volume_of(folder, "ramp", {64, 2, 2}, ramp(64), medium) + light;
  const auto shade = [&](const std::string& highlight) {
    return look(scene_of(dvr(text("lighting", "gradient") + text("highlight", highlight) +
                             number("termination", 0)),
                         content),
                kAlongX, 0, true)
        .radiance;
  };
  const double pi = 3.14159265358979;
  EXPECT_NEAR(shade("halfway"), 2 / pi * (0.5 * 0.7 * 0.5 + 0.3 * std::pow(std::cos(pi / 6), 4)), 2e-5);
  EXPECT_NEAR(shade("reflection"), 2 / pi * (0.5 * 0.7 * 0.5 + 0.3 * std::pow(std::cos(pi / 3), 4)), 2e-5);
}

TEST(Dvr, SurfacesAndOverlappingVolumes) {
  const VolumeFolder folder;
  const std::string one = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 2"));
  const std::string lamp =
      R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate x="0.5" y="0.5" z="0.5"/></transform>
                              <emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>)";
  const Seen seen = look(scene_of(dvr(number("termination", 0)), one + lamp), kAlongZ);
  EXPECT_NEAR(seen.radiance, (1 - std::exp(-1.0)) + 5 * std::exp(-1.0),
              2e-3);  // the lamp's <rgb> is upsampled
  EXPECT_NEAR(seen.alpha, 1, 1e-6);
  EXPECT_NEAR(look(scene_of(dvr(number("termination", 0)),
                            one + volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 1"))),
                   kAlongZ)
                  .radiance,
              1 - std::exp(-3.0), 2e-6);
}

TEST(Dvr, ColoursAreThoseOfTheFile) {
  const VolumeFolder folder;
  const auto scene =
      scene_of(dvr(""), volume_of(folder, "slab", {2, 2, 2}, kOnes,
                                  text("extinction", "0 50") + text("colors", "0 0.8 0.4 0.1")));
  // The colour by the CIE observer, from many wavelengths.
  double rgb_sum[3] = {0, 0, 0};
  const SpectralGrid grid = scene.scene->wavelengths().grid();
  const auto observer = observer_xyz(grid);
  constexpr int kCount = 512;
  for (int i = 0; i < kCount; ++i) {
    const Sampler& sampler = scene.scene->sensor().sensor->sampler();
    Path path;
    path.samples = SampleStream(sampler, 7, std::uint32_t(i));
    path.wavelengths = scene.scene->wavelengths().sample((float(i) + 0.5f) / kCount);
    path.samples.set_first(SampleStream::camera_dimensions(false));
    path.ray = kAlongZ;
    std::vector<Splat> splats;
    scene.integrator->trace(*scene.scene, std::span(&path, 1), splats, {});
    double xyz[3];
    for (int c = 0; c < 3; ++c)
      xyz[c] = double(sum(path.result.estimate * observer[std::size_t(c)].eval(path.wavelengths)));
    float rgb[3];
    xyz_to_srgb(xyz, rgb);
    for (int c = 0; c < 3; ++c) rgb_sum[c] += double(rgb[c]) / kCount;
  }
  const double scale = 0.8 / rgb_sum[0];
  EXPECT_NEAR(rgb_sum[1] * scale, 0.4, 0.003);
  EXPECT_NEAR(rgb_sum[2] * scale, 0.1, 0.003);
}

TEST(Dvr, WhatIsBehindDoesNotShineThroughAnEndedRay) {
  const VolumeFolder folder;
  const std::string thick =
      volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 20") + number("emission_scale", 0.5));
  const std::string sky =
      R"(<emitter type="constant"><spectrum name="radiance" type="d65"><float name="scale" value="10000"/></spectrum></emitter>)";
  EXPECT_NEAR(look(scene_of(dvr(""), thick + sky), kAlongZ).radiance, 0.5, 1e-3);
  EXPECT_NEAR(look(scene_of(dvr(text("method", "xray")), thick), kAlongZ).radiance, 2.0612e-9, 1e-12);
  EXPECT_NEAR(look(scene_of(dvr(R"(<boolean name="measures" value="true"/>)"), thick), kAlongZ).measures[0],
              20, 1e-3);
}

TEST(Dvr, NarrowFunctionsAreIntegrated) {
  const VolumeFolder folder;
  for (const double at : {0.3333, 0.4141, 0.777}) {
    const std::string curve = fmt::format("{0} 0, {0} 1000, {1} 1000, {1} 0", at, at + 1e-3);
    const auto content = volume_of(folder, "ramp", {64, 2, 2}, ramp(64), text("extinction", curve));
    EXPECT_NEAR(look(scene_of(dvr(text("method", "emission_absorption")), content), kAlongX).radiance,
                1 - std::exp(-1.0), 2e-3)
        << at;
  }
}

TEST(Dvr, OpacityByTheGradient) {
  const VolumeFolder folder;
  // The numbers of the ramp grow by 1 per unit of length.
  const auto thickness = [&](const std::string& parameters) {
    const auto content = volume_of(folder, "ramp", {64, 2, 2}, ramp(64), parameters);
    return look(scene_of(dvr(R"(<boolean name="measures" value="true"/>)" + number("step", 0.002)), content),
                kAlongX)
        .measures[0];
  };
  const std::string inside = text("clip_box", "0.1 0 0 0.9 1 1");
  EXPECT_NEAR(thickness(text("extinction", "0 50") + text("gradient_opacity", "0 1") + inside), 40, 1e-3);
  EXPECT_NEAR(thickness(text("extinction", "0 50") + text("gradient_opacity", "0 0, 2 1") + inside), 20,
              0.01);
  EXPECT_NEAR(thickness(text("opacity", "0 0.8") + text("gradient_opacity", "0 0, 2 1") + inside),
              -0.8 * std::log(0.6), 1e-3);
  // At the border, too, where differences are one-sided.
  EXPECT_NEAR(thickness(text("extinction", "0 50") + text("gradient_opacity", "0 0, 2 1")), 25, 0.5);
}

TEST(Dvr, ShadowsBeginInsideShapesSmallerThanTheGrid) {
  const VolumeFolder folder;
  const std::string light = R"(<emitter type="directional"><vector name="direction" x="0" y="0" z="1"/>
                               <spectrum name="irradiance" value="3"/></emitter>)";
  const std::string parameters =
      text("extinction", "0 2") + text("colors", "0 0.6 0.6 0.6") + text("color_is", "albedo");
  std::string small = volume_of(folder, "slab", {2, 2, 2}, kOnes, parameters);
  small.replace(small.find("1.02"), 4, "0.96");
  double sum = 0;
  const auto scene = scene_of(dvr(text("method", "single_scattering") + number("step", 0.02)), small + light);
  for (int i = 0; i < 32; ++i) sum += look(scene, kAlongZ, i, true).radiance / 32;
  const double exact = 0.6 * 3 / (4 * 3.14159265358979) * (1 - std::exp(-4.0)) / 2;
  EXPECT_NEAR(sum, exact, 0.02 * exact);
}

TEST(Dvr, ShadowsOfOtherVolumesAndSurfaces) {
  const VolumeFolder folder;
  const std::string light = R"(<emitter type="directional"><vector name="direction" x="-1" y="0" z="0"/>
                               <spectrum name="irradiance" value="2"/></emitter>)";
  const std::string shaded =
      volume_of(folder, "ramp", {64, 2, 2}, ramp(64),
                text("extinction", "0 1e-4") + number("ambient", 0) + number("specular", 0));
  std::string dark =
      volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 1.5") + text("colors", "0 0 0 0"));
  // The dark cube lies beside the shaded one, before the light.
  dark.insert(dark.find("</transform>"), R"(<translate x="1.5"/>)");
  dark.insert(dark.find("</volume>"), R"(<transform name="to_world"><translate x="1.5"/></transform>)");
  const auto see = [&](const std::string& content, bool shadows) {
    const std::string parameters = text("lighting", "gradient") + number("termination", 0) +
                                   number("step", 0.02) +
                                   (shadows ? R"(<boolean name="shadows" value="true"/>)" : "");
    return look(scene_of(dvr(parameters), shaded + light + content), {{0.5f, 0.5f, -1}, {0, 0, 1}}, 0, true)
        .radiance;
  };
  const double open = see("", true);
  EXPECT_NEAR(open, see(dark, false), 1e-4 * open);
  EXPECT_NEAR(see(dark, true) / open, std::exp(-1.5), 1e-3);
  const std::string wall =
      R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="90"/><translate x="1.4"/></transform></shape>)";
  EXPECT_EQ(see(wall, true), 0);
}

TEST(Dvr, PlateausAreOneSurface) {
  const VolumeFolder folder;
  std::vector<float> values;
  for (int i = 0; i < 8 * 8 * 8; ++i) values.push_back(i % 8 >= 2 && i % 8 < 6 ? 1.f : 0.f);
  for (const char* value : {"0.5", "1"}) {
    const auto scene = scene_of(dvr(text("method", "isosurface") + text("isovalues", value) +
                                    R"(<boolean name="measures" value="true"/>)"),
                                volume_of(folder, "block", {8, 8, 8}, values, text("opacity", "0 0.5")));
    for (const Ray& ray :
         {kAlongX, Ray{{2, 0.5f, 0.5f}, {-1, 0, 0}}, Ray{{-1, 0.4f, 0.3f}, {0.98f, 0.1f, 0.172f}}})
      EXPECT_NEAR(look(scene, ray).measures[0], 2 * std::log(2.0), 1e-5) << value;
  }
}

TEST(Dvr, DistantSensors) {
  const VolumeFolder folder;
  const std::string content = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 1"));
  const auto scene =
      scene_of(dvr(R"(<boolean name="measures" value="true"/>)" + number("step", 0.0015)), content);
  for (const float distance : {1e2f, 1e3f, 1e4f, 1e5f})
    EXPECT_NEAR(look(scene, {{0.5f, 0.5f, -distance}, {0, 0, 1}}).measures[0], 1, 1e-4) << distance;
}

TEST(Dvr, ColouredEmissionIsThatOfPath) {
  const VolumeFolder folder;
  const std::string content =
      volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 2") + text("colors", "0 1 1 0"));
  const auto steps = scene_of(dvr(number("termination", 0)), content), paths = scene_of(R"(path">)", content);
  constexpr int kCount = 2048;
  const double expected = mean_radiance(steps, kAlongZ, kCount).mean;
  const auto [mean, error] = mean_radiance(paths, kAlongZ, kCount);
  EXPECT_LT(error, 0.01 * expected);
  EXPECT_NEAR(mean, expected, 4 * error);
}

// Steps add up to the length of the ray, however short they are.
TEST(Dvr, ShortStepsAddUp) {
  const VolumeFolder folder;
  const std::string content = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 2"));
  for (const double step : {1e-3, 1e-4, 1e-5, 0.0}) {
    const std::string parameters =
        number("step", step > 0 ? step : 1.0 / 300) + "<boolean name=\"measures\" value=\"true\"/>";
    EXPECT_NEAR(look(scene_of(dvr(text("method", "average") + parameters), content), kAlongX).measures[1], 1,
                2e-6);
    for (const char* order : {"front_to_back", "back_to_front"})  // both loops
      EXPECT_NEAR(look(scene_of(dvr(text("order", order) + parameters), content), kAlongX).measures[0], 2,
                  1e-4)
          << step << order;
  }
}

// A preset of CT or MR has the opacities of 1 mm, whatever the unit of the scene.
TEST(Dvr, PresetsHaveTheOpacitiesOfAMillimetre) {
  const VolumeFolder folder;
  const std::vector<float> bone(8, 700);  // ct_bone: the opacity 0.5
  const auto alpha = [&](const std::string& unit, double thickness, const std::string& parameters) {
    const std::string content =
        volume_of(folder, "bone", {2, 2, 2}, bone,
                  parameters + text("clip_box", "0 0 0 1 1 " + std::to_string(thickness)));
    return look(scene_of(dvr(""), text("length_unit", unit) + content), kAlongZ).alpha;
  };
  const std::string preset = text("preset", "ct_bone");
  EXPECT_NEAR(alpha("mm", 0.5, preset), 1 - std::sqrt(0.5), 1e-5);
  EXPECT_NEAR(alpha("cm", 0.1, preset), 0.5, 1e-5);
  EXPECT_NEAR(alpha("m", 0.002, preset), 0.75, 1e-4);
  EXPECT_NEAR(alpha("cm", 0.5, preset + number("opacity_unit_length", 1)), 1 - std::sqrt(0.5), 1e-5);
  // Opacities of one's own are those of a unit of the scene, also with the colours of a preset.
  EXPECT_NEAR(alpha("cm", 0.5, preset + text("opacity", "0 0.3")), 1 - std::sqrt(0.7), 1e-5);
  // Layers of the methods that know no steps.
  const std::string whole = volume_of(folder, "bone", {2, 2, 2}, bone, preset);
  for (const char* unit : {"mm", "cm"})
    EXPECT_NEAR(look(scene_of(dvr(text("method", "mip")), text("length_unit", unit) + whole), kAlongZ).alpha,
                0.5, 1e-5);
  // Classes of both kinds need a length for all.
  const std::string labels =
      write_bytes(folder.path() / "labels.vol", make_vol({2, 1, 1}, 1, {1, 2}).bytes()).string();
  const std::string mixed = R"(<volume type="gridvolume" name="mask"><string name="filename" value=")" +
                            labels + R"("/></volume>)" + text("preset", "1: ct_bone") +
                            text("opacity", "2: 0 0.3");
  const auto problem_in = [&](const std::string& unit, const std::string& more) {
    return problem(dvr(""),
                   text("length_unit", unit) + volume_of(folder, "bone", {2, 2, 2}, bone, mixed + more));
  };
  EXPECT_EQ(problem_in("mm", ""), "");
  EXPECT_NE(problem_in("cm", "").find("state \"opacity_unit_length\" for all"), std::string::npos)
      << problem_in("cm", "");
  EXPECT_EQ(problem_in("cm", number("opacity_unit_length", 0.1)), "");
}

// Parameters without an effect are noted when the scene is loaded.
TEST(Dvr, WhatHasNoEffectIsNoted) {
  const VolumeFolder folder;
  const auto notes = [&](const std::string& integrator, const std::string& parameters,
                         const std::string& more = "") {
    const auto scene =
        scene_of(integrator,
                 volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "0 0.5") + parameters) + more);
    std::string all;
    for (const std::string& note : scene.notes) all += note + "\n";
    return all;
  };
  const std::string sun = R"(<emitter type="directional"/>)", lit = text("lighting", "gradient");
  const auto expect = [](const std::string& all, const std::string& part) {
    EXPECT_NE(all.find(part), std::string::npos) << all << "lacks " << part;
    EXPECT_NE(all.find("dvr.xml:"), std::string::npos) << all;
  };
  EXPECT_EQ(notes(dvr(""), ""), "");
  EXPECT_EQ(notes(dvr(lit), number("diffuse", 0.5), sun), "");
  const std::string surface = text("method", "isosurface") + text("isovalues", "7");
  expect(notes(dvr(surface), ""), "the surface of 7 is not seen");
  expect(notes(R"(aov"><string name="aovs" value="dd:depth"/><integrator type="dvr">)" + surface +
                   "</integrator>",
               ""),
         "the surface of 7 is not seen");
  expect(notes(dvr(lit), ""), "the scene has no light");
  expect(notes(dvr(""), number("shininess", 3)), "\"shininess\" of \"classified\": has no effect without");
  EXPECT_EQ(notes(dvr(text("method", "mip")), number("shininess", 3)), "");
  expect(notes(dvr(""), R"(<phase type="hg"/>)"), "the phase function has no effect");
  expect(notes(dvr(lit), text("color_is", "albedo") + number("sampling_weight", 2), sun), "emits no light");
  expect(notes(dvr(""), text("clip_planes", "0 0 1 -5, 0 0 2 4")),
         "nothing of the volume is left where (0, 0, 1) . p >= 2");
  EXPECT_EQ(notes(dvr(""), text("clip_planes", "0 0 1 0.5")), "");
  // A shape without a BSDF is a diffuse body.
  std::string body = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "0 0.5"));
  const std::string null = R"(<bsdf type="null"/>)";
  body.erase(body.find(null), null.size());
  const auto of_body = scene_of(dvr(""), body).notes;
  ASSERT_EQ(of_body.size(), 1u);
  expect(of_body[0], "<bsdf type=\"null\"/> shows it");
  // A shape in half of the volume: other integrators show less.
  const std::string file = (folder.path() / "slab.vol").string();
  const auto within = [&](double scale) {
    std::string grid = grid_xml(file);
    grid.insert(grid.find(' '), R"( name="value")");
    const auto scene = scene_of(
        dvr(""), R"(<shape type="cube"><transform name="to_world"><scale value=")" + std::to_string(scale) +
                     R"("/><translate x="0.5" y="0.5" z="0.5"/></transform><bsdf type="null"/>
        <medium type="classified" name="interior">)" +
                     grid + text("opacity", "0 0.5") + "</medium></shape>");
    return scene.notes.empty() ? "" : scene.notes.front();
  };
  expect(within(0.2),
         "the volume reaches from (0.25, 0.25, 0.25) to (0.75, 0.75, 0.75), beyond the shape that holds it, "
         "which reaches from (0.3, 0.3, 0.3) to (0.7, 0.7, 0.7)");
  EXPECT_EQ(within(0.25), "");  // half a voxel around the centres counts as rounding
  EXPECT_EQ(within(0.55), "");
}

TEST(Dvr, BadInputIsLocated) {
  const VolumeFolder folder;
  const auto medium = [&](const std::string& parameters) {
    return problem(dvr(""), volume_of(folder, "slab", {2, 2, 2}, kOnes, parameters));
  };
  EXPECT_NE(medium("").find("dvr.xml:"), std::string::npos);
  EXPECT_NE(medium("").find("parameter \"opacity\" of \"classified\": is missing: give \"opacity\""),
            std::string::npos)
      << medium("");
  EXPECT_NE(
      medium(text("preset", "generic") + text("color_encoding", "srgb")).find("colour maps and presets"),
      std::string::npos);
  EXPECT_NE(medium(text("opacity", "1 0, 0 0.5")).find("must ascend, but 0 follows 1"), std::string::npos);
  EXPECT_NE(medium(text("opacity", "0 0, 1 1.5")).find("from 0 to 1"), std::string::npos);
  EXPECT_NE(medium(text("opacity", "0 0, 1")).find("found 3 numbers"), std::string::npos);
  EXPECT_NE(medium(text("preset", "ct_bones")).find("ct_bone"), std::string::npos);
  EXPECT_NE(medium(text("opacity", "0 0.5") + text("color_map", "virids")).find("viridis"),
            std::string::npos);
  EXPECT_NE(medium(text("opacity", "0 0.5") + text("clip_box", "1 0 0 0 1 1")).find("lower corner"),
            std::string::npos);
  EXPECT_NE(medium(text("opacity", "0 0.5") + text("color_is", "albedo")).find("lighting"),
            std::string::npos);
  const std::string good = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "0 0.5"));
  EXPECT_NE(
      problem(dvr(text("method", "isosurface")), good).find("is missing: the numbers of the volume where"),
      std::string::npos)
      << problem(dvr(text("method", "isosurface")), good);
  EXPECT_NE(problem(dvr(text("method", "mip") + text("form", "premultiplied")), good).find("composite"),
            std::string::npos);
  EXPECT_NE(problem(dvr(""), "").find("classified"), std::string::npos);
  EXPECT_NE(problem(dvr(number("step", -1)), good).find("step"), std::string::npos);
  EXPECT_NE(problem(dvr(text("method", "mip") + number("tolerance", 0.1)), good).find("emission_absorption"),
            std::string::npos);
  const std::string fog =
      R"(<shape type="sphere"><bsdf type="null"/><medium type="homogeneous" name="interior"/></shape>)";
  EXPECT_NE(problem(dvr(""), good + fog).find("of the type \"classified\" alone"), std::string::npos)
      << problem(dvr(""), good + fog);
  std::vector<float> colours;
  for (int i = 0; i < 24; ++i) colours.push_back(float(i % 3) / 4);
  std::string colored = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("opacity", "0 0.5"));
  write_bytes(folder.path() / "slab.vol", make_vol({2, 2, 2}, 3, colours).bytes());
  EXPECT_NE(problem(dvr(""), colored).find("holds colours; one number"), std::string::npos)
      << problem(dvr(""), colored);
  std::vector<float> broken = kOnes;
  broken[3] = std::nanf("");
  EXPECT_NE(problem(dvr(""), volume_of(folder, "nan", {2, 2, 2}, broken, text("opacity", "0 0.5")))
                .find("dvr.xml:"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::test
