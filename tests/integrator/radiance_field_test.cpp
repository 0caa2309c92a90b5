// SPDX-License-Identifier: Apache-2.0
// Radiance grids along rays: against numpy's numbers (tests/medium/data/make_radiance_grids.py), closed forms, and `path`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "aureole/core/image.h"
#include "aureole/integrator/radiance/radiance_march.h"
#include "aureole/loading/load.h"
#include "aureole/parameter/grid/zip_archive.h"
#include "aureole/render/plan.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "harness/rendered.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

fs::path grid_folder() { return source_dir() / "tests/medium/data/radiance"; }

std::shared_ptr<const RadianceMedium> grid_of(const fs::path& file, const std::string& parameters = "") {
  return testing::build<RadianceMedium>(
      R"(<medium type="radiance_grid"><string name="filename" value="g.npz"/>)" + parameters + "</medium>",
      testing::make_context(), [&](const std::string&) { return file; });
}

RadianceSettings nerf_steps(float voxels) {
  RadianceSettings s{};
  s.method = RadianceSettings::Method::nerf;
  s.samples = RadianceSettings::Samples::start;
  s.step = voxels, s.density_limit = 1e-10f, s.termination = 0;
  return s;
}
RadianceSettings exact_integral(bool linear = false) {
  RadianceSettings s{};
  s.method = RadianceSettings::Method::exact;
  s.blends_linear = linear;
  return s;
}

std::vector<double> numbers_in(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> all;
  for (double x; in >> x;) all.push_back(x);
  return all;
}
Vec3 vector_of(const std::vector<double>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

TEST(RadianceField, RaysAsNumpyFollowsThem) {
  std::ifstream lines(source_dir() / "tests/medium/data/radiance.txt");
  std::map<std::string, std::shared_ptr<const RadianceMedium>> grids;
  std::map<std::string, double> most;
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    std::vector<std::string> part;
    std::istringstream in(line);
    for (std::string p; std::getline(in, p, ';');) part.push_back(p);
    ASSERT_EQ(part.size(), 5u);
    auto& grid = grids[part[0]];
    if (!grid) grid = grid_of(grid_folder() / part[0]);
    RadianceSettings s = nerf_steps(part[1] == "fine" ? 0.01f : 0.5f);
    if (part[1] == "exact" || part[1] == "linear") s = exact_integral(part[1] == "linear");
    s.last_is_opaque = part[1] == "opaque";
    const Ray ray{vector_of(numbers_in(part[2])), vector_of(numbers_in(part[3]))};
    const std::vector<double> expected = numbers_in(part[4]);
    const RadianceResult r = march_radiance(*grid, s, ray, 0);
    for (std::size_t k = 0; k < 4; ++k) {
      const double found = double(k < 3 ? r.color[k] : r.transmittance);
      EXPECT_NEAR(found, expected[k], 2e-5) << line;
      most[part[1]] = std::max(most[part[1]], std::abs(found - expected[k]));
    }
  }
  EXPECT_EQ(count, 200);
  for (const auto& [what, difference] : most) RecordProperty(what, fmt::format("{:.2g}", difference));
}

/// A grid along x of voxels with an edge of 1 from x = 0, with densities and colours of degree 0; 1 x 1 voxels wide.
RadianceVoxels row_of(const std::vector<float>& densities, const std::vector<float>& colors) {
  RadianceVoxels g;
  const int n = int(densities.size());
  g.size = {n, 1, 1};
  g.radius = {0.5f * float(n), 0.5f, 0.5f}, g.center = {0.5f * float(n), 0, 0};
  for (int i = 0; i < n; ++i) {
    g.links.push_back(i);
    g.densities.push_back(densities[std::size_t(i)]);
    for (int k = 0; k < 3; ++k) g.harmonics.push_back((colors[std::size_t(i)] - 0.5f) / 0.28209479f);
  }
  return g;
}

/// Along the row, from before it.
const Ray kAlong{{-1, 0.1f, -0.2f}, {1, 0, 0}};

TEST(RadianceField, ConstantGridsHaveAClosedForm) {
  const SplatFolder folder;
  const fs::path file = folder.path() / "row.npz";
  write_radiance_voxels(file, row_of({0.7f, 0.7f, 0.7f}, {0.75f, 0.75f, 0.75f}));
  const auto grid = grid_of(file);
  const double passed = std::exp(-0.7 * 3);
  // A sum of steps that divide the ray is exact where density and colour are constant.
  for (const RadianceSettings& s : {nerf_steps(0.5f), nerf_steps(0.05f), exact_integral()}) {
    const RadianceResult r = march_radiance(*grid, s, kAlong, 0);
    EXPECT_NEAR(r.transmittance, passed, 2e-6);
    EXPECT_NEAR(r.color[0], 0.75 * (1 - passed), 2e-5);  // harmonics of float16
  }
  // Half of the light is lost after ln 2 / 0.7 from x = 0, where the row begins.
  EXPECT_NEAR(march_radiance(*grid, exact_integral(), kAlong, 0).depth, 1 + std::log(2.) / 0.7, 0.26);
  // A larger grid is as opaque.
  const auto large = grid_of(file, R"(<transform name="to_world"><scale value="8"/></transform>)");
  EXPECT_NEAR(march_radiance(*large, exact_integral(), kAlong, 0).transmittance, passed, 2e-6);
  const auto dense = grid_of(file, R"(<float name="extinction_scale" value="2"/>)");
  EXPECT_NEAR(march_radiance(*dense, exact_integral(), kAlong, 0).transmittance, passed * passed, 2e-6);
}

TEST(RadianceField, RampsHaveAClosedForm) {
  const SplatFolder folder;
  const fs::path file = folder.path() / "row.npz";
  // The density is 0 up to x = 1/2, rises to 4 at 3/2, and stays. Thickness: 0, 2 u^2, 2 + 4 (x - 3/2).
  write_radiance_voxels(file, row_of({0, 4}, {0.5f, 0.5f}));
  const RadianceResult ramp = march_radiance(*grid_of(file), exact_integral(), kAlong, 0);
  EXPECT_NEAR(ramp.transmittance, std::exp(-4.), 1e-7);
  EXPECT_NEAR(ramp.color[0], 0.5 * (1 - std::exp(-4.)), 1e-6);
  // A negative density counts as 0 after interpolation: it ends where -1 + 5 u = 0.
  write_radiance_voxels(file, row_of({-1, 4}, {0.5f, 0.5f}));
  EXPECT_NEAR(march_radiance(*grid_of(file), exact_integral(), kAlong, 0).transmittance,
              std::exp(-(0.5 * 4 * 0.8 + 2)), 1e-6);
  // Density 3; the colour is a = 0.25 up to 1/2, rises to 1 at 3/2. Of a linear colour a + b u over [0, 1]:
  // a (1 - e) + b ((1 - e) / 3 - e) with e = exp(-3).
  write_radiance_voxels(file, row_of({3, 3}, {0.25f, 1}));
  const RadianceResult tint = march_radiance(*grid_of(file), exact_integral(), kAlong, 0);
  const double e = std::exp(-3.), h = std::exp(-1.5), a = 0.25, b = 0.75;
  EXPECT_NEAR(tint.color[1], a * (1 - h) + h * (a * (1 - e) + b * ((1 - e) / 3 - e)) + h * e * 1 * (1 - h),
              5e-4 * 0.25);
  // The sum of NeRF converges to it: with the order 1 of steps' beginnings, with the order 2 of their middles.
  const auto error = [&](RadianceSettings::Samples samples, float step) {
    RadianceSettings s = nerf_steps(step);
    s.samples = samples;
    return std::abs(double(march_radiance(*grid_of(file), s, kAlong, 0).color[1]) - double(tint.color[1]));
  };
  const double start = error(RadianceSettings::Samples::start, 0.25f),
               halved = error(RadianceSettings::Samples::start, 0.125f);
  EXPECT_GT(start, 0.01);
  EXPECT_NEAR(start / halved, 2, 0.2);
  const double middle = error(RadianceSettings::Samples::middle, 0.25f),
               middle_halved = error(RadianceSettings::Samples::middle, 0.125f);
  EXPECT_LT(middle, 0.2 * start);
  EXPECT_NEAR(middle / middle_halved, 4, 0.5);
}

TEST(RadianceField, JitteredSamplesAreOneInEachStep) {
  const SplatFolder folder;
  const fs::path file = folder.path() / "row.npz";
  write_radiance_voxels(file, row_of({1, 2, 0.5f, 3}, {0.2f, 0.9f, 0.4f, 0.7f}));
  const auto grid = grid_of(file);
  RadianceSettings s = nerf_steps(0.5f);
  s.samples = RadianceSettings::Samples::jittered;
  double sum = 0, low = 1, high = 0;
  for (std::uint64_t key = 0; key < 400; ++key) {
    const double c = double(march_radiance(*grid, s, kAlong, key).color[0]);
    sum += c, low = std::min(low, c), high = std::max(high, c);
  }
  EXPECT_GT(high - low, 0.01);
  EXPECT_NEAR(sum / 400, double(march_radiance(*grid, exact_integral(), kAlong, 0).color[0]), 0.03);
}

std::string look_at_grid(const std::string& integrator, const fs::path& file, const std::string& more = "",
                         const std::string& parameters = "") {
  return integrator +
         R"(<sensor type="radiancemeter"><vector name="origin" x="-0.4" y="0.3" z="4"/><vector name="direction" x="0.1" y="-0.1" z="-1"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="4096"/></sampler></sensor>)" +
         more +
         R"(<shape type="cube"><transform name="to_world"><scale value="3"/></transform><bsdf type="null"/>
    <medium type="radiance_grid" name="interior"><string name="filename" value=")" +
         file.string() + R"("/>)" + parameters + "</medium></shape>";
}
const char* const kExact =
    R"(<integrator type="radiance_field"><string name="method" value="exact"/><string name="color_space" value="linear"/></integrator>)";
const char* const kPath = R"(<integrator type="path"/>)";

TEST(RadianceField, PathsFindTheIntegral) {
  // Light of the environment passes, and a surface within the grid hides what is behind it.
  const std::string sky = R"(<emitter type="constant"><float name="radiance" value="0.3"/></emitter>)",
                    wall =
                        R"(<shape type="rectangle"><transform name="to_world"><translate z="0.3"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf></shape>)";
  for (const char* name : {"sh2.npz", "sh3.npz"})
    for (const std::string& more : {std::string(), sky, sky + wall}) {
      const fs::path file = grid_folder() / name;
      const double expected = testing::render(look_at_grid(kExact, file, more)).all;
      EXPECT_GT(expected, 0.05);
      testing::expect_mean(testing::render(look_at_grid(kPath, file, more)), expected, 0.01);
      // Sampling its emission as that of a light changes nothing either.
      testing::expect_mean(
          testing::render(look_at_grid(kPath, file, more, R"(<float name="sampling_weight" value="1"/>)")),
          expected, 0.01);
    }
}

TEST(RadianceField, LightsASurfaceInPath) {
  // An opaque grid of the colour 1 in all directions: its irradiance on a plane is that of a box that emits.
  const SplatFolder folder;
  const fs::path file = folder.path() / "row.npz";
  write_radiance_voxels(file, row_of({3000, 3000}, {1, 1}));
  const auto lit = [&](const std::string& light) {
    return testing::render(
        R"(<integrator type="path"/><sensor type="radiancemeter"><vector name="origin" x="1" y="-1" z="3"/><vector name="direction" x="0" y="0" z="-1"/>
      <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
      <sampler type="sobol"><integer name="sample_count" value="8192"/></sampler></sensor>
    <shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></shape>)" +
        light);
  };
  const double box =
      lit(R"(<shape type="cube"><transform name="to_world"><scale x="1" y="0.5" z="0.5"/><translate x="1"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf><emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter></shape>)")
          .all;
  const auto grid = [&](const std::string& weight) {
    return lit(
        R"(<shape type="cube"><transform name="to_world"><scale value="2.9"/></transform><bsdf type="null"/>
      <medium type="radiance_grid" name="interior"><string name="filename" value=")" +
        file.string() + "\"/>" + weight + "</medium></shape>");
  };
  EXPECT_GT(box, 0.02);
  testing::expect_mean(grid(R"(<float name="sampling_weight" value="1"/>)"), box, 0.05 * box);
  testing::expect_mean(grid(""), box, 0.05 * box);
}

TEST(RadianceField, LightPathsCarryItByDirection) {
  // A grid of harmonics lights a plane beside it: paths from the camera and paths from the grid find one irradiance.
  const auto lit = [&](const std::string& integrator) {
    return testing::render(
        "<integrator type=\"" + integrator +
        R"("/><sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
      <lookat origin="0, 0, 6" target="0, -3, -2" up="0, 1, 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/><rfilter type="box"/></film>
      <sampler type="sobol"><integer name="sample_count" value="4096"/></sampler></sensor>
    <shape type="rectangle"><transform name="to_world"><scale value="20"/><rotate x="1" angle="-90"/><translate y="-2.5"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0.8"/></bsdf></shape>
    <shape type="cube"><transform name="to_world"><scale value="2.2"/></transform><bsdf type="null"/>
      <medium type="radiance_grid" name="interior"><string name="filename" value=")" +
        (grid_folder() / "sh2.npz").string() + "\"/></medium></shape>");
  };
  const testing::Picture path = lit("path");
  EXPECT_GT(path.all, 0.01);
  for (const char* integrator : {"ptracer", "bdpt"}) {
    const testing::Picture other = lit(integrator);
    EXPECT_NEAR(other.all, path.all, 4.5 * std::hypot(other.all_error, path.all_error)) << integrator;
    EXPECT_LT(other.all_error, 0.02 * path.all);
  }
}

TEST(RadianceField, WhatItCannotShowIsALocatedError) {
  const auto fault = [](const std::string& content) -> std::string {
    try {
      const LoadedScene loaded =
          load_scene_from_string(R"(<scene version="3.0.0">)" + content + "</scene>", "grid.xml");
      loaded.integrator->require_scene(*loaded.scene);
    } catch (const std::exception& problem) {
      return problem.what();
    }
    return "";
  };
  const std::string two =
      R"(<shape type="cube"><bsdf type="null"/><medium type="homogeneous" name="interior"/></shape>)";
  EXPECT_NE(fault(look_at_grid(kExact, grid_folder() / "sh2.npz", two)).find("this medium would not be seen"),
            std::string::npos);
  EXPECT_NE(fault(std::string(kExact) + "<sensor type=\"perspective\"/>" + two)
                .find("shows a medium of the type \"radiance_grid\""),
            std::string::npos);
  EXPECT_NE(
      fault(
          look_at_grid(
              R"(<integrator type="radiance_field"><string name="method" value="exact"/><float name="step" value="2"/></integrator>)",
              grid_folder() / "sh2.npz"))
          .find("has no effect on the exact integral"),
      std::string::npos);
  const SplatFolder folder;
  const auto empty = folder.path() / "empty.npz";
  write_radiance_voxels(empty, row_of({-1, 0}, {1, 1}));
  EXPECT_NE(fault(look_at_grid(kExact, empty)).find("has no density above 0"), std::string::npos);
}

TEST(RadianceVoxels, WrittenFilesAreReadAgain) {
  const SplatFolder folder;
  for (const char* name : {"sh0.npz", "sh1.npz", "sh2.npz", "sh3.npz"}) {
    const RadianceVoxels from = read_radiance_voxels(grid_folder() / name);
    EXPECT_EQ(from.degree, name[2] - '0');
    write_radiance_voxels(folder.path() / "g.npz", from);
    const RadianceVoxels to = read_radiance_voxels(folder.path() / "g.npz");
    EXPECT_EQ(to.size, from.size);
    EXPECT_EQ(to.center, from.center);
    EXPECT_EQ(to.radius, from.radius);
    EXPECT_EQ(to.links, from.links);
    EXPECT_EQ(to.densities, from.densities);
    EXPECT_EQ(to.harmonics, from.harmonics);
    EXPECT_TRUE(is_radiance_voxels_file(folder.path() / "g.npz"));
  }
}

std::string npy(const std::string& type, const std::string& shape, const std::string& numbers) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  header.resize(117, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\0", 8) + char(header.size()) + '\0' + header + numbers;
}

TEST(RadianceVoxels, FilesThatLie) {
  const SplatFolder folder;
  const auto floats = [](std::initializer_list<float> v) {
    std::string s;
    for (const float x : v) s.append(reinterpret_cast<const char*>(&x), 4);
    return s;
  };
  const auto integers = [](std::initializer_list<std::int32_t> v) {
    std::string s;
    for (const auto x : v) s.append(reinterpret_cast<const char*>(&x), 4);
    return s;
  };
  using Members = std::map<std::string, std::string>;
  const Members good = {{"links.npy", npy("<i4", "2, 1, 1", integers({0, -1}))},
                        {"density_data.npy", npy("<f4", "1, 1", floats({2}))},
                        {"sh_data.npy", npy("<f4", "1, 3", floats({1, 0, -1}))},
                        {"radius.npy", npy("<f4", "3,", floats({1, 1, 1}))}};
  const auto file_with = [&](const Members& changed) {
    Members all = good;
    for (const auto& [name, bytes] : changed) all[name] = bytes;
    std::vector<std::pair<std::string, std::string>> members;
    for (const auto& [name, bytes] : all)
      if (!bytes.empty()) members.emplace_back(name, bytes);
    return folder.write("lie.npz", make_zip(members));
  };
  const auto fault = [&](const fs::path& file) -> std::string {
    try {
      read_radiance_voxels(file);
    } catch (const Error& problem) {
      EXPECT_EQ(problem.where().file.str(), file.string());
      return problem.message();
    }
    return "";
  };
  EXPECT_EQ(fault(file_with({})), "");
  const struct {
    Members changed;
    const char* expected;
  } cases[] = {
      {{{"links.npy", ""}}, "has no array \"links\""},
      {{{"links.npy", npy("<i4", "2, 1, 1", integers({0, 7}))}}, "are beyond the 1 stored voxels"},
      {{{"links.npy", npy("<i4", "2, 1, 1", integers({-1, -1}))}}, "the grid is empty"},
      {{{"links.npy", npy("<i4", "2000, 2000, 2000", integers({0}))}}, "is truncated: its numbers need"},
      {{{"links.npy", npy("<i4", "2", integers({0, 0}))}}, "along three axes"},
      {{{"links.npy", npy("<f4", "2, 1, 1", floats({0, 0}))}}, "whole numbers along three axes"},
      {{{"links.npy", npy("<i4", "-2, 1, 1", integers({0, 0}))}}, "of a negative size"},
      {{{"links.npy", npy("<x4", "2, 1, 1", integers({0, 0}))}}, "array \"links\": has numbers of the type"},
      {{{"density_data.npy", npy("<f4", "2, 1", floats({1, 1}))}}, "those of 2 stored voxels are expected"},
      {{{"sh_data.npy", npy("<f4", "1, 5", floats({1, 1, 1, 1, 1}))}}, "3, 12, 27 or 48 of each voxel"},
      {{{"radius.npy", npy("<f4", "3,", floats({1, 0, 1}))}}, "has the radius 1, 0, 1"},
      {{{"radius.npy", npy("<f4", "2,", floats({1, 1}))}}, "3 are expected, of x, y and z"},
      {{{"basis_type.npy", npy("<i4", "", integers({4}))}}, "learned functions are not"},
  };
  for (const auto& c : cases) {
    const std::string found = fault(file_with(c.changed));
    EXPECT_NE(found.find(c.expected), std::string::npos) << c.expected << "\n" << found;
  }
  const RadianceVoxels noted =
      read_radiance_voxels(file_with({{"sh_data.npy", npy("<f4", "1, 3", floats({1, NAN, -1}))},
                                      {"background_data.npy", npy("<f4", "1", floats({1}))}}));
  ASSERT_EQ(noted.notes.size(), 2u);
  EXPECT_NE(noted.notes[0].find("background of spheres"), std::string::npos);
  EXPECT_NE(noted.notes[1].find("1 of 1 stored voxels with a number that is not finite"), std::string::npos);
}

TEST(RadianceVoxels, DamagedFilesAreErrors) {
  const SplatFolder folder;
  std::mt19937 random(5);
  int errors = 0, read = 0;
  for (const char* name : {"sh0.npz", "sh1.npz", "sh2.npz", "sh3.npz"}) {
    const std::string whole = read_bytes(grid_folder() / name);
    for (int i = 0; i < 400; ++i) {
      std::string s = i % 4 == 0 ? whole.substr(0, random() % whole.size()) : whole;
      if (i % 4 != 0)
        for (unsigned k = 0; k <= random() % 4; ++k) {
          // Half of the changes fall on the headers and the directory.
          const std::size_t at = random() % 2
                                     ? random() % s.size()
                                     : s.size() - 1 - random() % std::min<std::size_t>(s.size(), 400);
          s[at] = char(random());
        }
      const fs::path file = folder.write("damaged.npz", s);
      try {
        const RadianceVoxels g = read_radiance_voxels(file);
        ++read;
        for (const std::int32_t link : g.links) ASSERT_LT(link, std::int32_t(g.stored()));
        for (const float x : g.harmonics) ASSERT_TRUE(std::isfinite(x));
      } catch (const Error& problem) {
        ++errors;
        ASSERT_EQ(problem.where().file.str(), file.string());
      }
    }
  }
  EXPECT_EQ(errors + read, 1600);
  EXPECT_GT(errors, 500);
}

}  // namespace
}  // namespace aureole::test
