// SPDX-License-Identifier: Apache-2.0
// `direct` in media: closed forms, one technique against another, and `path` where nothing that a medium scatters
// counts.
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

std::string direct(int light, int scatter) {
  return "<integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"" + std::to_string(light) +
         "\"/><integer name=\"bsdf_samples\" value=\"" + std::to_string(scatter) + "\"/></integrator>";
}
std::string floor() {
  return "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"9\"/></transform><bsdf "
         "type=\"diffuse\">" +
         parameter("reflectance", 0.6) + "</bsdf></shape>";
}
std::string cube(double half, const std::string& content) {
  return "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"" + number(half) +
         "\"/><translate z=\"1.2\"/></transform>" + kNull + content + "</shape>";
}

TEST(DirectThroughMedia, AGlowingSlabIsSeen) {
  // Parallel rays through a cube of edge 2: emission (1 - exp(-sigma L)) / sigma, whatever of sigma scatters.
  for (const double sigma_s : {0.0, 0.7})
    expect_mean(render(direct(1, 1) + parallel(2, 16) + "<shape type=\"cube\">" + kNull +
                       medium(0.4, sigma_s, 0, 3) + "</shape>"),
                3 * (1 - std::exp(-2 * (0.4 + sigma_s))) / (0.4 + sigma_s));
}

TEST(DirectThroughMedia, AGlowingGridIsSeen) {
  // Nearest voxels along z: each of half a unit emits 2 and attenuates what lies below.
  const std::vector<float> sigma{0.3f, 2, 0, 1};
  VolumeFolder folder;
  const std::string place =
      test::choice("filter_type", "nearest") +
      "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale "
      "value=\"2\"/></transform>";
  std::string volume =
      grid_xml(write_bytes(folder.path() / "t.vol", make_vol({1, 1, 4}, 1, sigma).bytes()), place);
  volume.insert(volume.find(' '), " name=\"sigma_t\"");
  double expected = 0;
  for (const float s : sigma)  // upwards, towards the camera
    expected = expected * std::exp(-0.5 * s) + 2 * (s > 0 ? (1 - std::exp(-0.5 * s)) / s : 0.5);
  expect_mean(render(direct(1, 1) + parallel(2, 256) + "<shape type=\"cube\">" + kNull +
                     "<medium type=\"heterogeneous\" name=\"interior\">" + volume + parameter("emission", 2) +
                     "</medium></shape>"),
              expected);
}

struct Room {
  const char* name;
  std::string content;
};
std::vector<Room> rooms() {
  const std::string lamp =
      "<shape type=\"sphere\"><point name=\"center\" x=\"0.2\" y=\"0\" z=\"1.2\"/>" +
      parameter("radius", 0.7) +
      "<emitter type=\"area\"><rgb name=\"radiance\" value=\"2, 3, 1\"/></emitter></shape>";
  const std::string grid = "<medium type=\"heterogeneous\" name=\"interior\">GRID" + parameter("scale", 2) +
                           "<rgb name=\"albedo\" value=\"0.5, 0.2, 0.7\"/>";
  return {{"Lamp", lamp + cube(1.1, medium(0.4, 1))},
          {"LampInAGrid", lamp + cube(1.1, grid + "</medium>")},
          {"Glow", cube(1.1, medium(0.4, 1, 0, 3))},
          {"GlowingGrid", cube(1.1, grid + "<rgb name=\"emission\" value=\"3, 1, 0.5\"/></medium>")},
          {"LampInGlow", lamp + cube(1.1, medium(0.4, 1, 0, 3))}};
}
class DirectInMedia : public ::testing::TestWithParam<Room> {};
INSTANTIATE_TEST_SUITE_P(Rooms, DirectInMedia, ::testing::ValuesIn(rooms()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(DirectInMedia, AllSamplesBringTheSame) {
  VolumeFolder folder;
  std::vector<float> values(4 * 4 * 4);
  std::uint32_t state = 5;
  for (float& v : values) v = float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
  std::string grid =
      grid_xml(write_bytes(folder.path() / "t.vol", make_vol({4, 4, 4}, 1, values).bytes()),
               "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale "
               "value=\"2.2\"/><translate z=\"1.2\"/></transform>");
  grid.insert(grid.find(' '), " name=\"sigma_t\"");
  std::string content = GetParam().content;
  if (const auto at = content.find("GRID"); at != std::string::npos) content.replace(at, 4, grid);
  const auto scene = [&](const std::string& integrator, int samples) {
    return render(integrator +
                  camera("origin=\"0, -6, 3\" target=\"0, 0, 0.6\" up=\"0, 0, 1\"", 35, 4, samples) +
                  floor() + content);
  };
  const Picture both = scene(direct(2, 1), 128);
  const Picture others[] = {
      scene(direct(1, 0), 256), scene(direct(0, 1), 256),
      scene("<integrator type=\"path\"><integer name=\"max_depth\" value=\"2\"/><integer "
            "name=\"max_scattering\" value=\"0\"/></integrator>",
            64)};
  const char* const names[] = {"lights alone", "directions alone", "path"};
  for (int k = 0; k < 3; ++k) {
    const double error = std::hypot(both.all_error, others[k].all_error);
    EXPECT_NEAR(both.all, others[k].all, 4.5 * error) << names[k];
    EXPECT_LT(error, 0.02 * both.all) << names[k];
    for (std::size_t i = 0; i < both.mean.size(); ++i)
      EXPECT_NEAR(both.mean[i], others[k].mean[i],
                  6 * std::hypot(both.error[i], others[k].error[i]) + 1e-3 * both.all)
          << names[k] << ", pixel " << i;
  }
}

}  // namespace
}  // namespace aureole::testing
