// SPDX-License-Identifier: Apache-2.0
// Pictures of media on grids: the grid, its resolution and the bounds made of it must not show.
#include <gtest/gtest.h>

#include <cmath>

#include "harness/rendered.h"
#include "medium/scene_text.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

using aureole::test::choice;
using aureole::test::grid_over_cube;
using aureole::test::grid_xml;
using aureole::test::make_vol;
using aureole::test::VolumeFolder;
using aureole::test::write_bytes;

/// Expects equal pictures up to noise, in the mean and in every pixel.
void expect_same(const Picture& a, const Picture& b, const std::string& what, double largest_error = 0.02) {
  const double error = std::hypot(a.all_error, b.all_error);
  EXPECT_NEAR(a.all, b.all, 4.5 * error + 1e-4 * a.all) << what;
  EXPECT_LT(error, largest_error * a.all) << what;
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    EXPECT_NEAR(a.mean[i], b.mean[i], 6 * std::hypot(a.error[i], b.error[i]) + 1e-3 * a.all)
        << what << ", pixel " << i;
}

/// A grid that fills [-1, 1]^3, as the parameter `name`.
std::string filling(const std::filesystem::path& file, const std::string& name, const std::string& filter) {
  return grid_over_cube(file, name, choice("filter_type", filter));
}

/// A cube of a medium between a floor, a lamp near it and the sky.
Picture picture(const std::string& integrator, const std::string& content, int samples = 128) {
  return render(
      "<integrator type=\"" + integrator + "\"/>" +
      camera("origin=\"0, -6, 2\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 30, 4, samples) +
      "<shape type=\"cube\">" + kNull + content +
      "</shape><shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"3\"/><translate "
      "z=\"-1.1\"/></transform></shape><shape type=\"sphere\"><point name=\"center\" x=\"-0.4\" "
      "y=\"-1.2\" z=\"0.5\"/><float name=\"radius\" value=\"0.1\"/><emitter type=\"area\"><float "
      "name=\"radiance\" value=\"20\"/></emitter></shape><emitter type=\"constant\"><float "
      "name=\"radiance\" value=\"0.3\"/></emitter>");
}
std::string heterogeneous(const std::string& grid, double scale) {
  return "<medium type=\"heterogeneous\" name=\"interior\">" + grid + parameter("scale", scale) +
         parameter("albedo", 0.8) + "<phase type=\"hg\">" + parameter("g", 0.4) + "</phase></medium>";
}

TEST(GridTransport, AConstantGridIsHomogeneous) {
  VolumeFolder folder;
  const auto file =
      write_bytes(folder.path() / "one.vol", make_vol({3, 3, 3}, 1, std::vector<float>(27, 0.5f)).bytes());
  for (const char* integrator : {"path", "ptracer"})
    expect_same(picture(integrator, heterogeneous(filling(file, "sigma_t", "trilinear"), 2.4)),
                picture(integrator, medium(0.24, 0.96, 0.4)), integrator);
}

// Positions along rays that are sampled by the light must end at the box, too (equiangular sampling).
TEST(GridTransport, AMediumEndsAtTheBoxOfItsVolume) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "one.vol", make_vol({1, 1, 1}, 1, {1}).bytes());
  // Three quarters of the cube's length, turned; as the place of [0, 1]^3 and of [-1, 1]^3.
  const std::string turned = "<rotate z=\"1\" angle=\"20\"/></transform>";
  const std::string place =
      "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale value=\"1.5\"/>" +
      turned;
  const auto named = [](std::string volume) { return volume.insert(volume.find(' '), " name=\"sigma_t\""); };
  const std::string constant = "<volume type=\"constvolume\">" + parameter("value", 1) + place + "</volume>";
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    const Picture smaller = picture(integrator, "<transform name=\"to_world\"><scale value=\"0.75\"/>" +
                                                    turned + heterogeneous(parameter("sigma_t", 1), 1.2));
    expect_same(smaller, picture(integrator, heterogeneous(named(constant), 1.2)), integrator);
    expect_same(smaller, picture(integrator, heterogeneous(named(grid_xml(file, place)), 1.2)), integrator);
  }
}

TEST(GridTransport, AnyMajorantGivesTheSame) {
  // One field in 4^3 voxels, which have one bound, and in 16^3, which have 4^3 bounds; and both with a voxel of 8 in
  // a corner that little light passes, which raises the one bound.
  VolumeFolder folder;
  const auto write = [&](int fineness, float corner, const std::string& name) {
    const int n = 4 * fineness;
    std::vector<float> values;
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const int cell = (z / fineness * 4 + y / fineness) * 4 + x / fineness;
          values.push_back(cell == 63 ? corner : cell % 3 == 0 ? 0.f : float(cell * 37 % 11) / 10);
        }
    return write_bytes(folder.path() / name, make_vol({n, n, n}, 1, values).bytes());
  };
  const auto render_of = [](const std::filesystem::path& file) {
    return picture("path", heterogeneous(filling(file, "sigma_t", "nearest"), 3));
  };
  const Picture coarse = render_of(write(1, 1, "coarse.vol"));
  expect_same(coarse, render_of(write(4, 1, "fine.vol")), "finer");
  // One voxel of 8 in a field of at most 1: the only bound of 4^3 voxels is eight times as high.
  const Picture loose = render_of(write(1, 8, "loose.vol")), tight = render_of(write(4, 8, "tight.vol"));
  expect_same(loose, tight, "looser");
}

TEST(GridTransport, ExtinctionsThreeDecadesApart) {
  VolumeFolder folder;
  std::vector<float> values;
  for (int i = 0; i < 8; ++i) values.insert(values.end(), {0.9f, 0.03f, 0.0009f});
  const auto file = write_bytes(folder.path() / "rgb.vol", make_vol({2, 2, 2}, 3, values).bytes());
  for (const char* integrator : {"path", "ptracer"})
    expect_same(picture(integrator, heterogeneous(filling(file, "sigma_t", "trilinear"), 6)),
                picture(integrator,
                        "<medium type=\"homogeneous\" name=\"interior\"><rgb name=\"sigma_t\" "
                        "value=\"0.9, 0.03, 0.0009\"/>" +
                            parameter("scale", 6) + parameter("albedo", 0.8) + "<phase type=\"hg\">" +
                            parameter("g", 0.4) + "</phase></medium>"),
                integrator);
}

TEST(GridTransport, ThickGridsKeepTheFurnaceWhite) {
  // Where little light arrives straight ahead connections end by roulette, which must be in no weight.
  VolumeFolder folder;
  std::vector<float> values(6 * 6 * 6);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i * 7 % 5 < 2 ? 0.f : float(i * 7 % 5) / 4;
  const auto file = write_bytes(folder.path() / "thick.vol", make_vol({6, 6, 6}, 1, values).bytes());
  const Picture p =
      render(path() + camera("origin=\"0, -6, 2\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 15, 4, 256) +
             "<shape type=\"cube\">" + kNull + "<medium type=\"heterogeneous\" name=\"interior\">" +
             filling(file, "sigma_t", "trilinear") + parameter("scale", 6) + parameter("albedo", 1) +
             "</medium></shape>" + kSky);
  expect_mean(p, 1, 0.003);
  expect_pixels(p, 1);
}

TEST(GridTransport, TheMeanChordIsThatOfTheBody) {
  // A medium that only scatters and emits one unit per length sends out 4 pi V, whatever the grid, the phase
  // function and the boundary: the mean path is 4 V / S.
  VolumeFolder folder;
  constexpr double kMeter = 1.05, kVolume = 4.0 / 3 * M_PI;
  std::uint32_t state = 5;
  for (const int n : {2, 7}) {
    std::vector<float> values(std::size_t(n * n * n));
    for (float& v : values)
      v = std::max(0.f, float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f - .4f);
    const auto file = write_bytes(folder.path() / "s.vol", make_vol({n, n, n}, 1, values).bytes());
    for (const auto& [boundary, g] :
         {std::pair<std::string, double>{kNull, 0.7},
          {"<bsdf type=\"roughdielectric\"><float name=\"alpha\" value=\"0.4\"/><float name=\"int_ior\" "
           "value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/><boolean name=\"energy_preserving\" "
           "value=\"true\"/></bsdf>",
           -0.5}}) {
      const Picture p =
          render("<integrator type=\"path\"/><shape type=\"sphere\"><float name=\"radius\" value=\"" +
                 number(kMeter) +
                 "\"/><boolean name=\"flip_normals\" value=\"true\"/><bsdf type=\"diffuse\"><float "
                 "name=\"reflectance\" value=\"0\"/></bsdf><sensor type=\"irradiancemeter\">" +
                 film(1, 512) + "</sensor></shape>" +
                 ball(boundary, "<medium type=\"heterogeneous\" name=\"interior\">" +
                                    filling(file, "sigma_t", "trilinear") + parameter("scale", 6) +
                                    parameter("albedo", 1) + parameter("emission", 1) +
                                    "<phase type=\"hg\">" + parameter("g", g) + "</phase></medium>"));
      EXPECT_NEAR(p.all * kMeter * kMeter, kVolume, 4.5 * p.all_error + 1e-3 * kVolume) << n << ", g " << g;
      EXPECT_LT(p.all_error, 0.02 * p.all);
    }
  }
}

}  // namespace
}  // namespace aureole::testing
