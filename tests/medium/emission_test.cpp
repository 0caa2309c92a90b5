// SPDX-License-Identifier: Apache-2.0
// Media that emit, as lights: closed forms, and connections against walks that find the emission by themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/rendered.h"
#include "medium/scene_text.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

using aureole::test::grid_xml;
using aureole::test::make_vol;
using aureole::test::VolumeFolder;
using aureole::test::write_bytes;

std::string named(std::string volume, const std::string& name) {
  return volume.insert(volume.find(' '), " name=\"" + name + "\"");
}
std::string weight(double w) { return parameter("sampling_weight", w); }
std::string floor(double reflectance) {
  return "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"9\"/></transform><bsdf "
         "type=\"diffuse\">" +
         parameter("reflectance", reflectance) + "</bsdf></shape>";
}

TEST(EmittingMedia, AGlowingBallLightsAFloorAsAPoint) {
  // Without absorption its field is that of all its power in the centre: E = emission V cos / d^2 on a floor.
  const double radius = 0.5, height = 3, x = 1.5, reflectance = 0.6;
  const double d2 = height * height + x * x, volume = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  const double expected = reflectance / std::numbers::pi * 7 * volume * height / std::pow(d2, 1.5);
  const auto scene = [&](double sampling_weight, int samples) {
    return render(
        "<integrator type=\"path\"><integer name=\"max_depth\" value=\"2\"/></integrator>" +
        camera("origin=\"1.5, -8, 5\" target=\"1.5, 0, 0\" up=\"0, 0, 1\"", 0.01, 2, samples) +
        floor(reflectance) + "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"3\"/>" +
        parameter("radius", radius) + kNull + "<medium type=\"homogeneous\" name=\"interior\">" +
        parameter("sigma_t", 0) + parameter("emission", 7) + weight(sampling_weight) + "</medium></shape>");
  };
  const Picture connected = scene(1, 64);
  expect_mean(connected, expected);
  expect_mean(scene(0, 1024), expected);
  EXPECT_LT(connected.all_error, 0.3 * scene(0, 64).all_error);
}

TEST(EmittingMedia, AGlowingGridLightsAFloor) {
  // Voxels of random emission in [-1, 1]^3 about (0, 0, 3), almost clear; the radiance of the floor at the
  // origin by the midpoints of eight parts of each.
  const int n = 6;
  std::vector<float> values(n * n * n);
  std::uint32_t state = 1;
  for (float& v : values) v = float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
  for (std::size_t i = 0; i < values.size(); i += 3) values[i] = 0;
  double expected = 0;
  const int parts = 4 * n;
  for (int z = 0; z < parts; ++z)
    for (int y = 0; y < parts; ++y)
      for (int x = 0; x < parts; ++x) {
        const double px = 2 * (x + .5) / parts - 1, py = 2 * (y + .5) / parts - 1,
                     pz = 2 * (z + .5) / parts + 2;
        expected += double(values[std::size_t((z / 4 * n + y / 4) * n + x / 4)]) * pz /
                    std::pow(px * px + py * py + pz * pz, 1.5);
      }
  expected *= std::pow(2.0 / parts, 3) * 0.6 / std::numbers::pi;
  VolumeFolder folder;
  const std::string place =
      test::choice("filter_type", "nearest") +
      "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale value=\"2\"/><translate "
      "z=\"3\"/></transform>";
  const auto emission = write_bytes(folder.path() / "e.vol", make_vol({n, n, n}, 1, values).bytes());
  std::vector<float> faint(values.size(), 0.f);
  faint[5] = 1e-6f;
  const auto extinction = write_bytes(folder.path() / "t.vol", make_vol({n, n, n}, 1, faint).bytes());
  for (const int by_walk : {0, 1}) {
    const Picture p =
        render("<integrator type=\"path\"><integer name=\"max_depth\" value=\"2\"/></integrator>" +
               camera("origin=\"0, -8, 3\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 0.01, 2, by_walk ? 1024 : 64) +
               floor(0.6) + "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"3\"/>" +
               parameter("radius", 1.8) + kNull + "<medium type=\"heterogeneous\" name=\"interior\">" +
               named(grid_xml(extinction, place), "sigma_t") + named(grid_xml(emission, place), "emission") +
               weight(by_walk ? 0 : 1) + "</medium></shape>");
    expect_mean(p, expected, by_walk ? 0.05 : 0.02);
  }
}

struct Content {
  const char* name;
  std::string medium;  ///< parameters
  const char* type;
  bool lamp = false;  ///< a lamp beside it
};
std::vector<Content> contents() {
  const std::string rgb =
      "<rgb name=\"albedo\" value=\"0.5, 0.7, 0.2\"/><phase type=\"hg\">" + parameter("g", 0.4) + "</phase>";
  return {
      {"Thin",
       "<rgb name=\"sigma_t\" value=\"0.1, 0.2, 0.4\"/><rgb name=\"emission\" value=\"3, 1, 0.5\"/>" + rgb,
       "homogeneous"},
      {"Thick", "<rgb name=\"sigma_t\" value=\"9, 3, 1\"/><rgb name=\"emission\" value=\"9, 4, 2\"/>" + rgb,
       "homogeneous"},
      {"Hot", "<rgb name=\"sigma_t\" value=\"1, 2, 0.5\"/>" + parameter("temperature", 2500) + rgb,
       "homogeneous"},
      {"Grid", "SMOKE<rgb name=\"emission\" value=\"3, 1, 0.5\"/>" + parameter("scale", 2) + rgb,
       "heterogeneous"},
      {"HotGrid", "SMOKE" + parameter("temperature", 2500) + parameter("scale", 6) + rgb, "heterogeneous"},
      {"ThinByALamp",
       "<rgb name=\"sigma_t\" value=\"0.1, 0.2, 0.4\"/><rgb name=\"emission\" value=\"3, 1, 0.5\"/>" + rgb,
       "homogeneous", true},
      {"GridByALamp", "SMOKE<rgb name=\"emission\" value=\"3, 1, 0.5\"/>" + parameter("scale", 2) + rgb,
       "heterogeneous", true}};
}

class Emission : public ::testing::TestWithParam<Content> {};
INSTANTIATE_TEST_SUITE_P(Media, Emission, ::testing::ValuesIn(contents()),
                         [](const auto& info) { return std::string(info.param.name); });

/// A floor, a rough mirror and a ball of fog around or beside something that glows.
std::string room(const std::string& glowing) {
  return floor(0.5) +
         "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"0.4\"/><translate x=\"1.2\" y=\"0.5\" "
         "z=\"0.4\"/></transform><bsdf type=\"roughconductor\">" +
         parameter("alpha", 0.2) +
         "</bsdf></shape><shape type=\"sphere\"><point name=\"center\" x=\"-1.4\" y=\"0\" z=\"0.9\"/>" +
         parameter("radius", 0.6) + kNull + medium(0.1, 1.5, 0.3) +
         "</shape><shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"0.6\"/>" +
         parameter("radius", 0.75) + kNull + glowing + "</shape>";
}

/// A light near both, for which segments in media use equiangular sampling.
std::string lamp() {
  return "<shape type=\"sphere\"><point name=\"center\" x=\"-0.7\" y=\"-0.3\" z=\"1.5\"/>" +
         parameter("radius", 0.1) + "<emitter type=\"area\"><rgb name=\"radiance\" value=\"9, 20, 30\"/>" +
         "</emitter></shape>";
}

TEST_P(Emission, ConnectionsBringWhatWalksBring) {
  // The ball of the medium reaches below the floor, so that some vertices lie in it.
  VolumeFolder folder;
  std::vector<float> values(5 * 5 * 5);
  std::uint32_t state = 7;
  for (float& v : values)
    v = std::max(0.f, float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f - .4f);
  const auto file = write_bytes(folder.path() / "s.vol", make_vol({5, 5, 5}, 1, values).bytes());
  const std::string smoke = named(
      grid_xml(file,
               "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\"/><scale value=\"1.1\"/><rotate "
               "z=\"1\" angle=\"30\"/><translate z=\"-0.1\"/></transform>"),
      "sigma_t");
  std::string content = GetParam().medium;
  if (const auto at = content.find("SMOKE"); at != std::string::npos) content.replace(at, 5, smoke);
  const auto scene = [&](const std::string& integrator, double w, int samples) {
    return render("<integrator type=\"" + integrator +
                  "\"><integer name=\"max_depth\" value=\"6\"/></integrator>" +
                  camera("origin=\"0, -6, 3\" target=\"0, 0, 0.6\" up=\"0, 0, 1\"", 35, 4, samples) +
                  room("<medium type=\"" + std::string(GetParam().type) + "\" name=\"interior\">" + content +
                       weight(w) + "</medium>") +
                  (GetParam().lamp ? lamp() : ""));
  };
  const Picture connected = scene("path", 1, 64), walked = scene("path", 0, 256),
                traced = scene("ptracer", 1, 256);
  for (const Picture* other : {&walked, &traced}) {
    const double error = std::hypot(connected.all_error, other->all_error);
    EXPECT_NEAR(connected.all, other->all, 4.5 * error)
        << (other == &walked ? "by walks" : "from the medium");
    EXPECT_LT(error, 0.03 * connected.all);
    for (std::size_t i = 0; i < connected.mean.size(); ++i)
      EXPECT_NEAR(connected.mean[i], other->mean[i],
                  6 * std::hypot(connected.error[i], other->error[i]) + 1e-3 * connected.all)
          << "pixel " << i;
  }
}

TEST(EmittingMedia, HiddenEmittersHideNoMedium) {
  // Neither the sky nor the lamp before the ball is seen, but the ball's own light: (1 - exp(-sigma s)) e / sigma for a
  // chord s = 2 sqrt(1 - r^2).
  const double sigma = 0.8, emission = 2;
  const std::string scene = ball(kNull, medium(sigma, 0, 0, emission)) + kSky +
                            "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"2.5\"/>" +
                            parameter("radius", 0.7) + "<bsdf type=\"diffuse\">" +
                            parameter("reflectance", 0) + "</bsdf><emitter type=\"area\"/></shape>";
  const int n = 10000;
  double mean = 0;
  for (int i = 0; i < n; ++i)
    mean += -std::expm1(-2 * sigma * std::sqrt(1 - (i + 0.5) / n)) * emission / sigma / n;
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    SCOPED_TRACE(integrator);
    expect_mean(
        render("<integrator type=\"" + std::string(integrator) +
               "\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>" + parallel(8, 64) + scene),
        mean * std::numbers::pi / 4, 0.02);
  }
}

TEST(EmittingMedia, AGridInEquilibriumIsInvisible) {
  // Any extinction at the temperature of its surroundings, scattering or not.
  VolumeFolder folder;
  std::vector<float> values(7 * 7 * 7);
  std::uint32_t state = 3;
  for (float& v : values)
    v = std::max(0.f, float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f - .3f);
  const auto file = write_bytes(folder.path() / "s.vol", make_vol({7, 7, 7}, 1, values).bytes());
  const std::string place =
      "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale value=\"2\"/></transform>";
  const std::string sky =
      "<emitter type=\"constant\"><spectrum type=\"blackbody\" name=\"radiance\"><float name=\"temperature\" "
      "value=\"4000\"/></spectrum></emitter>";
  const std::string from =
      path() + camera("origin=\"0, -5, 1\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 25, 4, 256);
  const Picture empty = render(from + sky);
  for (const double albedo : {0.0, 0.6}) {
    const Picture p = render(
        from + sky + "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"1.01\"/></transform>" +
        kNull + "<medium type=\"heterogeneous\" name=\"interior\">" +
        named(grid_xml(file, place), "sigma_t") + parameter("albedo", albedo) + parameter("scale", 5) +
        parameter("temperature", 4000) + "</medium></shape>");
    expect_mean(p, empty.all, 0.02);
    expect_pixels(p, empty.all);
  }
}

}  // namespace
}  // namespace aureole::testing
