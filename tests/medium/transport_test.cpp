// SPDX-License-Identifier: Apache-2.0
// Light transport in media against closed forms and laws that hold for any medium.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/effort.h"
#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

struct Boundary {
  const char* name;
  std::string bsdf;
  double index;
};
std::vector<Boundary> boundaries() {
  const auto smooth = [](double n) {
    return "<bsdf type=\"dielectric\">" + parameter("ext_ior", 1) + parameter("int_ior", n) + "</bsdf>";
  };
  return {{"null", kNull, 1},
          {"smooth", smooth(1.5), 1.5},
          {"denser", smooth(2.4), 2.4},
          {"rough",
           "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"ggx\"/>" +
               parameter("alpha", 0.4) + parameter("ext_ior", 1) + parameter("int_ior", 1.5) +
               "<boolean name=\"energy_preserving\" value=\"true\"/></bsdf>",
           1.5}};
}

class InBoundary : public ::testing::TestWithParam<Boundary> {};
INSTANTIATE_TEST_SUITE_P(Media, InBoundary, ::testing::ValuesIn(boundaries()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(InBoundary, WhiteMediaVanishInTheFurnace) {
  const Picture p =
      render(path() + camera("origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 25, 4, 64) +
             ball(GetParam().bsdf, medium(0, 3, 0.6)) + kSky);
  expect_mean(p, 1, 0.03);
  expect_pixels(p, 1);
}

TEST_P(InBoundary, AnIsothermalEnclosureIsUniform) {
  // Kirchhoff's law: what absorbs as much as it emits, in a sky of its own temperature. Within an index n
  // radiance is n^2 times as large.
  const double n2 = GetParam().index * GetParam().index;
  for (const double scattering : {0.0, 2.0}) {
    const Picture p =
        render(path() + camera("origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 25, 4, 16) +
               ball(GetParam().bsdf, medium(0.8, scattering, 0.3, 0.8 * n2)) + kSky);
    expect_mean(p, 1);
    expect_pixels(p, 1);
  }
}

TEST_P(InBoundary, TheMeanChordIsFourVolumesOverTheSurface) {
  // Where a medium only scatters and emits one unit per length, the mean radiance that leaves it is the
  // mean length of paths through it: 4 V / S at any scattering, phase function and index. Seen from one
  // side, a ball fills pi / 4 of its square.
  for (const auto& [scattering, g] : {std::pair{0.0, 0.0}, {1.0, -0.5}, {4.0, 0.8}}) {
    // Nothing leads light out that runs around in a clear smooth ball.
    if (scattering == 0 && GetParam().bsdf.find("\"dielectric\"") != std::string::npos) continue;
    const Picture p = render(path() + parallel(8, 64) + ball(GetParam().bsdf, medium(0, scattering, g, 1)));
    expect_mean(p, 4.0 / 3 * std::numbers::pi / 4, 0.05);
  }
}

TEST(Media, ACameraInsideSeesTheSquaredIndex) {
  const auto inside = [](double n) {
    return render(
        path() + camera("origin=\"0.1, 0.2, 0.3\" target=\"1, 0, 0\" up=\"0, 1, 0\"", 60, 4, 16) +
        ball("<bsdf type=\"dielectric\">" + parameter("ext_ior", 1) + parameter("int_ior", n) + "</bsdf>",
             medium(0.5, 1, 0.3, 0.5 * n * n)) +
        kSky);
  };
  expect_mean(inside(1.5), 2.25);
  expect_pixels(inside(1.5), 2.25);
}

TEST(Media, AirlightOfSingleScattering) {
  // A beam along the view's direction through a ball: L = sigma_s p E (1 - exp(-2 sigma_t s)) / (2 sigma_t)
  // for a chord s. Its mean over the disc of radius 1 with chords 2 sqrt(1 - r^2).
  const double sigma_s = 0.7, sigma_t = 1.0;
  const std::string beam =
      "<emitter type=\"directional\"><vector name=\"direction\" value=\"0, 0, -1\"/><float "
      "name=\"irradiance\" value=\"3\"/></emitter>";
  const Picture p =
      render(path(1) + parallel(8, 64) + ball(kNull, medium(sigma_t - sigma_s, sigma_s)) + beam);
  const int n = 10000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double r2 = (i + 0.5) / n, chord = 2 * std::sqrt(1 - r2);
    sum += -std::expm1(-2 * sigma_t * chord) / (2 * sigma_t) / n;
  }
  expect_mean(p, sigma_s * 3 / (4 * std::numbers::pi) * sum * std::numbers::pi / 4);
}

TEST(Media, ExtinctionsThreeDecadesApart) {
  // The reflectance of a half-space depends on its albedo alone.
  const std::string mirrors = [] {
    std::string all;
    for (const char* turn : {"0", "90", "180", "270"})
      all +=
          "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"conductor\"><string "
          "name=\"material\" value=\"none\"/></bsdf></bsdf><transform name=\"to_world\"><rotate x=\"1\" "
          "angle=\"90\"/><translate y=\"1\"/><rotate z=\"1\" angle=\"" +
          std::string(turn) + "\"/></transform></shape>";
    return all;
  }();
  const Picture p = render(
      path() + parallel(4, 128) + mirrors +
      "<shape type=\"rectangle\"><bsdf type=\"null\"/><medium type=\"homogeneous\" name=\"interior\"><spectrum "
      "name=\"sigma_t\" value=\"360:60000, 500:60, 600:600, 700:6000, 830:60\"/>" +
      parameter("albedo", 0.9) + "</medium></shape>" + kSky);
  expect_mean(p, 0.414947, 0.008);
}

TEST(Media, HiddenSurfacesChangeNothing) {
  // Balls within one of higher priority are inactive, however often a ray hits them.
  const auto scene = [](bool hidden) {
    std::string all = "<shape type=\"sphere\"><integer name=\"priority\" value=\"9\"/>" + kNull +
                      medium(0.6, 1.2, 0.3) + "</shape>";
    for (int k = 1; hidden && k <= 6; ++k)
      all += "<shape type=\"sphere\"><integer name=\"priority\" value=\"2\"/>" +
             parameter("radius", 0.15 * k) + "<bsdf type=\"dielectric\"/>" + medium(30, 0) + "</shape>";
    return all + "<emitter type=\"point\"><point name=\"position\" x=\"3\" y=\"1\" z=\"2\"/></emitter>" +
           kSky;
  };
  const std::string from =
      camera("origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 25, 4, test::effort(96, 256));
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    const std::string method = "<integrator type=\"" + std::string(integrator) + "\"/>" + from;
    const Picture a = render(method + scene(false)), b = render(method + scene(true));
    const double error = std::hypot(a.all_error, b.all_error);
    EXPECT_NEAR(a.all, b.all, 4.5 * error) << integrator;
    EXPECT_LT(error, 0.02 * a.all) << integrator;
  }
}

/// Scenes that all of them render: a lamp and a floor in fog, the camera outside or inside.
TEST(Media, PathsOfLightBringTheSame) {
  const std::string scene =
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"2\"/><translate "
      "z=\"-0.8\"/></transform></shape><shape type=\"sphere\"><float name=\"radius\" value=\"2\"/>" +
      kNull +
      "<medium type=\"homogeneous\" name=\"interior\"><rgb name=\"sigma_t\" value=\"0.2, 0.5, 1.5\"/><rgb "
      "name=\"albedo\" value=\"0.9, 0.8, 0.6\"/><phase type=\"hg\"><float name=\"g\" "
      "value=\"0.5\"/></phase></medium></shape>"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"0.2\"/><point name=\"center\" x=\"0.5\" y=\"0\" "
      "z=\"0.3\"/><emitter type=\"area\"/></shape>";
  for (const char* origin : {"0, -6, 1", "0, -1.5, 0.5"}) {
    const std::string from =
        camera("origin=\"" + std::string(origin) + "\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 35, 4,
               test::effort(128, 256));
    const Picture a = render(path() + from + scene);
    for (const char* integrator : {"ptracer", "bdpt"}) {
      const Picture b = render("<integrator type=\"" + std::string(integrator) + "\"/>" + from + scene);
      EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error)) << integrator << " " << origin;
      EXPECT_LT(std::hypot(a.all_error, b.all_error), test::effort(0.04, 0.03) * a.all);
      for (std::size_t i = 0; i < a.mean.size(); ++i)
        EXPECT_NEAR(a.mean[i], b.mean[i], 6 * std::hypot(a.error[i], b.error[i]) + 1e-3 * a.all)
            << integrator << ", pixel " << i;
    }
  }
}

}  // namespace
}  // namespace aureole::testing
