// SPDX-License-Identifier: Apache-2.0
// tests/references/scenes/make_vdb.cpp wrote the files, and the values with OpenVDB's own interpolation.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <sstream>

#include "aureole/math/significance.h"
#include "harness/paths.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

std::filesystem::path sample(const std::string& extension) {
  return source_dir() / "tests/references/scenes/volumes" / ("cloud." + extension);
}
VolumePtr build_vdb(const std::filesystem::path& file, const std::string& parameters = "") {
  return testing::build<Volume>("<volume type=\"vdbvolume\"><string name=\"filename\" value=\"" +
                                file.string() + "\"/>" + parameters + "</volume>");
}

class VdbVolume : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, VdbVolume, ::testing::Values("vdb", "nvdb"));

TEST_P(VdbVolume, OpenVdbsValues) {
  const VolumePtr linear = build_vdb(sample(GetParam()));
  const VolumePtr nearest = build_vdb(sample(GetParam()), choice("filter_type", "nearest"));
  const VolumePtr warm = build_vdb(sample(GetParam()), choice("grid", "temperature"));
  std::ifstream in(source_dir() / "tests/volume/data/vdb_values.txt");
  std::string line;
  int lines = 0, inside = 0;
  for (; std::getline(in, line); ++lines) {
    Vec3 p;
    float l = 0, n = 0, t = 0;
    std::istringstream(line) >> p.x >> p.y >> p.z >> l >> n >> t;
    inside += l > 0;
    EXPECT_NEAR(linear->eval_scalar(p), l, 2e-5f) << line;
    EXPECT_NEAR(nearest->eval_scalar(p), n, 1e-6f) << line;
    EXPECT_NEAR(warm->eval_scalar(p), t, 2e-2f) << line;
  }
  EXPECT_EQ(lines, 60);
  EXPECT_GT(inside, 15);
  EXPECT_EQ(warm->minimum(), 300);
  EXPECT_EQ(linear->minimum(), 0);
}

TEST_P(VdbVolume, BoundsHold) {
  const VolumePtr volume = build_vdb(sample(GetParam()));
  const Transform from_box = volume->to_box()->inverse();
  const std::array<int, 3> cells{11, 4, 5};
  std::vector<float> bounds(220);
  volume->bound(cells, bounds);
  SeededRandom random(5);
  int empty = 0;
  for (std::size_t c = 0; c < bounds.size(); ++c) {
    empty += bounds[c] == 0;
    const float at[3] = {float(c % 11), float(c / 11 % 4), float(c / 44)};
    for (int i = 0; i < 100; ++i) {
      const Vec3 p{(at[0] + random.next()) / 11, (at[1] + random.next()) / 4, (at[2] + random.next()) / 5};
      ASSERT_LE(volume->eval_scalar(from_box.point(p)), bounds[c]);
    }
  }
  EXPECT_GT(empty, 15);
}

TEST_P(VdbVolume, ColoursAndVectors) {
  const VolumePtr color = build_vdb(sample(GetParam()), choice("grid", "color"));
  EXPECT_EQ(color->channels(), 1);
  EXPECT_GT(color->maximum(), .8f);
  const VolumePtr raw =
      build_vdb(sample(GetParam()), choice("grid", "color") + R"(<boolean name="raw" value="true"/>)");
  ASSERT_EQ(raw->channels(), 3);
  EXPECT_NEAR(raw->maximum(), .9f, 1e-6f);  // .1 (8 + 1)
}

TEST_P(VdbVolume, ToWorldComesAfterTheGridsOwnTransform) {
  const VolumePtr plain = build_vdb(sample(GetParam()));
  const VolumePtr moved =
      build_vdb(sample(GetParam()),
                R"(<transform name="to_world"><scale value="2"/><rotate z="1" angle="90"/></transform>)");
  SeededRandom random(2);
  const Transform from_box = plain->to_box()->inverse();
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = from_box.point({random.next(), random.next(), random.next()});
    EXPECT_NEAR(moved->eval_scalar({-2 * p.y, 2 * p.x, 2 * p.z}), plain->eval_scalar(p), 2e-5f);
  }
}

TEST_P(VdbVolume, WrongGridsAreLocatedErrors) {
  const auto error = [&](const std::string& parameters) {
    return error_thrown_by([&] { build_vdb(sample(GetParam()), parameters); });
  };
  const std::string unknown = error(choice("grid", "densty"));
  EXPECT_NE(unknown.find("has no grid \"densty\""), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("did you mean \"density\"?"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("snippet:1"), std::string::npos) << unknown;
}

TEST(NvdbVolume, QuantisedGridsAreDecoded) {
  const VolumePtr exact = build_vdb(sample("nvdb"));
  const VolumePtr coarse = build_vdb(sample("nvdb"), choice("grid", "quantised"));
  SeededRandom random(2);
  const Transform from_box = exact->to_box()->inverse();
  float largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = from_box.point({random.next(), random.next(), random.next()});
    largest = std::max(largest, std::abs(exact->eval_scalar(p) - coarse->eval_scalar(p)));
  }
  EXPECT_LE(largest, exact->maximum() / 255);
  EXPECT_GT(largest, 0);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The sample file without compression: a head of 16 bytes, for each grid one of 176 with its name, then the grids.
std::string decompressed_nvdb() {
  const std::string packed = bytes_of(sample("nvdb"));
  const auto number = [&](std::size_t at, auto kind) {
    std::memcpy(&kind, &packed.at(at), sizeof kind);
    return kind;
  };
  std::string out = packed.substr(0, 14) + std::string(2, '\0');
  const int grids = number(12, std::uint16_t());
  std::size_t at = 16;
  std::string data;
  std::vector<std::uint64_t> sizes;
  for (int i = 0; i < grids; ++i) {
    sizes.push_back(number(at, std::uint64_t()));
    const std::size_t bytes = 176 + number(at + 136, std::uint32_t());
    out += packed.substr(at, 8) + packed.substr(at, 8) + packed.substr(at + 16, bytes - 16);
    at += bytes;
  }
  for (const std::uint64_t size : sizes) {
    const auto from = number(at, std::uint64_t());
    std::string grid(size, '\0');
    uLongf got = size;
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(grid.data()), &got,
                         reinterpret_cast<const Bytef*>(&packed.at(at + 8)), from),
              Z_OK);
    data += grid;
    at += 8 + from;
  }
  EXPECT_EQ(at, packed.size());
  return out + data;
}

TEST(NvdbVolume, FilesWithoutCompression) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "a.nvdb", decompressed_nvdb());
  for (const char* grid : {"density", "temperature", "quantised"}) {
    const VolumePtr a = build_vdb(file, choice("grid", grid)),
                    b = build_vdb(sample("nvdb"), choice("grid", grid));
    const Vec3 p = a->to_box()->inverse().point({.4f, .5f, .45f});
    EXPECT_EQ(a->eval_scalar(p), b->eval_scalar(p));
    EXPECT_GT(a->eval_scalar(p), .1f);
  }
}

TEST(NvdbVolume, BadFilesAreLocatedErrors) {
  VolumeFolder folder;
  const auto error_with = [&](const std::string& bytes) {
    const auto file = write_bytes(folder.path() / "bad.nvdb", bytes);
    const std::string message = error_thrown_by([&] { build_vdb(file); });
    EXPECT_NE(message.find("bad.nvdb"), std::string::npos) << message;
    return message;
  };
  const std::string good = bytes_of(sample("nvdb"));
  EXPECT_NE(error_with("NanoVDB2" + good.substr(8)).find("begins with \"NanoVDB2\""), std::string::npos);
  EXPECT_NE(error_with("hello").find("is neither"), std::string::npos);
  std::string large = good;  // each grid claims 2^37 bytes
  std::uint16_t grids;
  std::memcpy(&grids, &good[12], sizeof grids);
  for (std::size_t at = 16, i = 0; i < grids; ++i) {
    const std::uint64_t claimed = std::uint64_t(1) << 37;
    std::uint32_t name;
    std::memcpy(&large[at], &claimed, sizeof claimed);
    std::memcpy(&name, &good[at + 136], sizeof name);
    at += 176 + name;
  }
  EXPECT_NE(error_with(large).find("compressed too well"), std::string::npos);
  EXPECT_NE(error_with(good.substr(0, good.size() - 9)).find("is truncated"), std::string::npos);
  EXPECT_NE(error_with(good.substr(0, 100)).find("is truncated"), std::string::npos);
}

// Whatever is damaged, nothing is read outside of the file's memory (make test-asan would tell).
TEST(NvdbVolume, DamagedNodesAreErrorsOrValues) {
  VolumeFolder folder;
  const std::string good = decompressed_nvdb();
  const std::size_t grid = good.find("density", 1000) - 40;  // its name in its own head
  const auto error_with = [&](const std::string& bytes) {
    const auto file = write_bytes(folder.path() / "bad.nvdb", bytes);
    return error_thrown_by([&] { build_vdb(file); });
  };
  ASSERT_EQ(error_with(good), "");
  // The distance from the tree, which follows the head of 672 bytes, to its root.
  for (const char byte : {'\xff', '\x21', '\x7f'}) {
    std::string bad = good;
    bad.replace(grid + 672 + 24, 8, std::string(8, byte));
    EXPECT_NE(error_with(bad).find("is damaged"), std::string::npos);
  }
  SeededRandom random(9);
  for (int round = 0; round < 60; ++round) {
    std::string bad = good;
    for (int i = 0; i < 3; ++i) {
      const std::size_t at = grid + 40 + std::size_t(random.next() * (round % 2 ? 1200 : 300000));
      for (std::size_t k = 0; k < 4; ++k) bad.at(at + k) = char(int(random.next() * 256));
    }
    const std::string message = error_with(bad);
    EXPECT_TRUE(message.empty() || message.find("bad.nvdb") != std::string::npos) << message;
  }
}

// A file of 30 KB describes boxes of 1e9 and 1e18 voxels.
TEST(VdbFiles, VoxelsFarApartNeedLittleMemoryOrAreErrors) {
  const auto file = source_dir() / "tests/references/scenes/volumes/far.vdb";
  const VolumePtr near = build_vdb(file, choice("grid", "near"));
  EXPECT_FLOAT_EQ(near->maximum(), 1);
  const std::string message = error_thrown_by([&] { build_vdb(file, choice("grid", "far")); });
  EXPECT_NE(message.find("far.vdb\" is too large: the box around the grid \"far\""), std::string::npos)
      << message;
}

TEST(VdbFiles, BadFilesAreLocatedErrors) {
  VolumeFolder folder;
  const std::string good = bytes_of(sample("vdb"));
  SeededRandom random(4);
  for (int round = 0; round < 20; ++round) {
    std::string bad = good.substr(0, std::size_t(.5f * random.next() * float(good.size())));
    if (bad.size() < 8) continue;
    // Half of the file ends before the last grid's own head.
    const auto file = write_bytes(folder.path() / "bad.vdb", bad);
    const std::string message = error_thrown_by([&] { build_vdb(file); });
    EXPECT_NE(message.find("bad.vdb"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace aureole::test
