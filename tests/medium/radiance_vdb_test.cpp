// SPDX-License-Identifier: Apache-2.0
// Radiance grids of OpenVDB, as OpenVDB's own Python module wrote them (tests/medium/data/make_vdb_radiance.py).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "aureole/core/error.h"
#include "aureole/loading/load.h"
#include "aureole/medium/radiance/radiance_medium.h"
#include "aureole/parameter/radiance/radiance_voxels.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

fs::path written_by_openvdb(const char* name) { return source_dir() / "tests/medium/data/radiance" / name; }

std::string fault_of(const fs::path& file) {
  try {
    read_radiance_voxels(file);
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), file.string());
    return e.message();
  }
  return "";
}

TEST(RadianceVdb, VoxelsAreThoseOfOpenVdb) {
  const RadianceVoxels g = read_radiance_voxels(written_by_openvdb("sh1.vdb"));
  // A margin of one voxel around the 3 x 4 x 5 voxels from (-1, 0, 2).
  EXPECT_EQ(g.size, (std::array<int, 3>{5, 6, 7}));
  EXPECT_EQ(g.degree, 1);
  EXPECT_FALSE(g.is_linear);
  EXPECT_TRUE(g.notes.empty());
  const double edge[3] = {0.5, 0.25, 1}, middle[3] = {10 + 0.5 * 0, -2 + 0.25 * 1.5, 0.5 + 4};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(g.radius[k], 0.5 * edge[k] * g.size[std::size_t(k)], 1e-6);
    EXPECT_NEAR(g.center[k], middle[k], 1e-6);
  }
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 6; ++j)
      for (int l = 0; l < 7; ++l) {
        const std::int32_t link = g.links[g.link_index(i, j, l)];
        ASSERT_GE(link, 0);  // The margin is stored for its colours.
        const bool is_margin = i == 0 || j == 0 || l == 0 || i == 4 || j == 5 || l == 6;
        const double x = i - 2, y = j - 1, z = l + 1;
        EXPECT_FLOAT_EQ(g.densities[std::size_t(link)], is_margin ? 0.f : float(1 + x / 4 - y / 8 + z / 16));
        if (is_margin) continue;
        const float* h = g.harmonics_of(std::size_t(link));
        for (int k = 0; k < 4; ++k) {
          EXPECT_FLOAT_EQ(h[3 * k], float(x / 128 + k / 8.));
          EXPECT_FLOAT_EQ(h[3 * k + 1], float(y / 64 - k / 8.));
          EXPECT_FLOAT_EQ(h[3 * k + 2], float(z / 32));
        }
      }
  // The voxel of the margin beyond a corner has one neighbour, and its colour.
  const float* corner = g.harmonics_of(std::size_t(g.links[g.link_index(0, 0, 0)]));
  EXPECT_FLOAT_EQ(corner[3], float(-1 / 128. + 1 / 8.));
}

TEST(RadianceVdb, TilesAndLinearColours) {
  const RadianceVoxels g = read_radiance_voxels(written_by_openvdb("cd.vdb"));
  EXPECT_EQ(g.size, (std::array<int, 3>{18, 10, 10}));
  EXPECT_EQ(g.degree, 0);
  EXPECT_TRUE(g.is_linear);
  std::size_t dense = 0;
  for (int i = 0; i < 18; ++i) {
    const std::int32_t link = g.links[g.link_index(i, 5, 5)];
    ASSERT_GE(link, 0);
    const float expected[3] = {0.25f, 0.5f, 1};
    // At the margin of lower x, too; voxels with a density but no colour are black.
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(0.5f + 0.28209479f * g.harmonics_of(std::size_t(link))[k], i <= 8 ? expected[k] : 0.f, 1e-6)
          << i;
  }
  for (const float d : g.densities) dense += d == 2;
  EXPECT_EQ(dense, 16u * 8 * 8);
  // Through the middle of the box of 1.6 x 0.8 x 0.8 the optical thickness is 3.2, and half a voxel falls off at either end.
  const auto medium = [&](const std::string& parameters) {
    return testing::build<RadianceMedium>(
        R"(<medium type="radiance_grid"><string name="filename" value="g.vdb"/>)" + parameters + "</medium>",
        testing::make_context(), [&](const std::string&) { return written_by_openvdb("cd.vdb"); });
  };
  const auto linear = medium("");
  EXPECT_FALSE(linear->is_encoded());
  EXPECT_TRUE(medium(R"(<string name="color_space" value="srgb"/>)")->is_encoded());
  double thickness = 0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 p{float(-0.2 + 2 * (i + 0.5) / kSteps), 0.35f, 0.35f};
    thickness += double(linear->field().density(linear->field().index_of(p))) * 2 / kSteps;
  }
  EXPECT_NEAR(thickness, 3.2, 0.002);
}

TEST(RadianceVdb, FilesThatAreNoRadianceGrids) {
  const SplatFolder folder;
  EXPECT_NE(
      fault_of(source_dir() / "tests/medium/data/turned.vdb").find("a transform that rotates or shears"),
      std::string::npos);
  const fs::path clouds = source_dir() / "tests/references/scenes/volumes";
  EXPECT_NE(fault_of(clouds / "cloud.vdb").find("a transform that rotates or shears"), std::string::npos);
  EXPECT_NE(fault_of(source_dir() / "tests/medium/data/plain.vdb").find("has no colours"), std::string::npos);
  EXPECT_EQ(fault_of(clouds / "far.vdb"), "has no grid \"density\"");
  // Every damaged file is a located error or a grid of finite numbers.
  std::mt19937 random(5);
  int errors = 0;
  // OpenVDB allocates the lengths that a damaged file states. Where that fails, the reader makes an error of it, but AddressSanitizer
  // ends the program: it is given truncated files alone.
  constexpr int kTruncated = 60, kAll = kSanitized ? kTruncated : 200;
  for (const char* name : {"sh1.vdb", "cd.vdb"}) {
    const std::string whole = read_bytes(written_by_openvdb(name));
    for (int i = 0; i < kAll; ++i) {
      std::string bytes = whole;
      if (i < kTruncated) bytes.resize(8 + random() % (whole.size() - 8));
      for (unsigned k = 0; i >= kTruncated && k <= random() % 4; ++k)
        bytes[8 + random() % (bytes.size() - 8)] = char(random());
      const fs::path file = folder.write("bad.vdb", bytes);
      try {
        const RadianceVoxels g = read_radiance_voxels(file);
        for (const float v : g.densities) ASSERT_TRUE(std::isfinite(v));
        for (const float v : g.harmonics) ASSERT_TRUE(std::isfinite(v));
      } catch (const Error& e) {
        ++errors;
        ASSERT_EQ(e.where().file.str(), file.string());
        ASSERT_FALSE(e.message().empty());
      }
    }
  }
  EXPECT_GT(errors, 100);
}

}  // namespace
}  // namespace aureole::test
