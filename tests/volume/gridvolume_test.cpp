// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "aureole/math/significance.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/upsampling.h"
#include "harness/paths.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

using testing::build;
using testing::make_context;
using testing::read_properties;

Wavelengths wavelengths(float first_nm = 400, float step_nm = 50) {
  return Wavelengths::at(SpectralGrid::over(360, 830),
                         make_spectrum([&](int i) { return first_nm + step_nm * float(i); }));
}

std::vector<float> noise(std::size_t count, std::uint64_t seed) {
  SeededRandom random(seed);
  std::vector<float> v(count);
  for (float& x : v) x = random.next();
  return v;
}

// tests/volume/data/make_grid_values.py describes the grid.
TEST(GridVolume, MitsubasValues) {
  VolumeFolder folder;
  std::vector<float> values;
  for (int i = 0; i < 120; ++i) values.push_back(float(std::fmod(i * 0.6180339887498949, 1.0)));
  VolFile vol = make_vol({6, 5, 4}, 1, values);
  vol.box = {1, 2, 3, 3, 3, 5};
  const auto file = write_bytes(folder.path() / "grid.vol", vol.bytes());
  std::ifstream in(source_dir() / "tests/volume/data/grid_values.txt");
  std::string filter, wrap, line;
  int lines = 0, box = 0;
  for (; std::getline(in, line); ++lines) {
    Vec3 p;
    float expected = 0;
    std::istringstream(line) >> filter >> wrap >> box >> p.x >> p.y >> p.z >> expected;
    const VolumePtr volume = build_grid(
        file,
        choice("filter_type", filter) + choice("wrap_mode", wrap) +
            "<boolean name=\"use_grid_bbox\" value=\"" + (box ? "true" : "false") +
            R"("/><transform name="to_world"><rotate z="1" angle="30"/><scale value="2"/></transform>)");
    EXPECT_NEAR(volume->eval_scalar(p), expected, 4e-6f) << line;
    EXPECT_EQ(volume->eval(p, wavelengths())[3], volume->eval_scalar(p));
  }
  EXPECT_EQ(lines, 96);
}

TEST(GridVolume, IsExactForLinearFunctionsBetweenTheCentres) {
  VolumeFolder folder;
  const std::array<int, 3> n{19, 9, 26};
  const auto f = [](double x, double y, double z) { return 3 + 2 * x - y + 0.5 * z; };
  std::vector<float> values;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        values.push_back(float(f((x + .5) / n[0], (y + .5) / n[1], (z + .5) / n[2])));
  const VolumePtr volume = build_grid(write_bytes(folder.path() / "a.vol", make_vol(n, 1, values).bytes()));
  SeededRandom random(3);
  for (int i = 0; i < 4000; ++i) {
    double p[3];
    for (std::size_t a = 0; a < 3; ++a) p[a] = (.5 + (n[a] - 1) * double(random.next())) / n[a];
    EXPECT_NEAR(volume->eval_scalar({float(p[0]), float(p[1]), float(p[2])}), f(p[0], p[1], p[2]), 4e-6);
  }
  EXPECT_EQ(volume->resolution(), n);
}

TEST(GridVolume, OtherEncodings) {
  VolumeFolder folder;
  VolFile vol = make_vol({2, 2, 1}, 1, {});
  vol.encoding = 2;
  vol.set_data(std::vector<std::uint16_t>{0x3c00, 0x3800, 0x0000, 0x4900});  // 1, .5, 0, 10
  VolumePtr volume = build_grid(write_bytes(folder.path() / "half.vol", vol.bytes()));
  EXPECT_EQ(volume->eval_scalar({.25f, .25f, .5f}), 1);
  EXPECT_EQ(volume->eval_scalar({.75f, .25f, .5f}), .5f);
  EXPECT_EQ(volume->eval_scalar({.75f, .75f, .5f}), 10);
  EXPECT_EQ(volume->maximum(), 10);
  EXPECT_EQ(volume->minimum(), 0);
  vol.encoding = 3;
  vol.set_data(std::vector<std::uint8_t>{0, 51, 102, 255});
  volume = build_grid(write_bytes(folder.path() / "byte.vol", vol.bytes()));
  EXPECT_FLOAT_EQ(volume->eval_scalar({.75f, .25f, .5f}), .2f);
  EXPECT_FLOAT_EQ(volume->eval_scalar({.75f, .75f, .5f}), 1);
}

// The spectrum of one colour is that of a texture; between voxels spectra are interpolated.
TEST(GridVolume, ColoursBecomeSpectraVoxelByVoxel) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "c.vol",
                                make_vol({3, 1, 1}, 3, {.2f, .5f, .9f, 0, 0, 0, 6, 3, .75f}).bytes());
  const VolumePtr volume = build_grid(file);
  const auto color = [](const std::string& rgb) {
    return build<Volume>("<volume type=\"constvolume\"><rgb name=\"value\" value=\"" + rgb + "\"/></volume>");
  };
  const VolumePtr blue = color("0.2, 0.5, 0.9"), bright = color("6, 3, 0.75");
  const Wavelengths w = wavelengths();
  const auto at = [&](float x) { return volume->eval({x, .5f, .5f}, w); };
  for (int i = 0; i < kWavelengths; ++i) {
    // The table of the texels and the fit of single colours differ by their tolerance.
    EXPECT_NEAR(at(.1f)[i], blue->eval({}, w)[i], 4e-3f);
    EXPECT_EQ(at(.5f)[i], 0);
    EXPECT_NEAR(at(.9f)[i], bright->eval({}, w)[i], .05f);
    EXPECT_NEAR(at(1.f / 3)[i], at(.1f)[i] / 2, 1e-6f);
    EXPECT_LE(at(.9f)[i], volume->maximum());
  }
  EXPECT_EQ(volume->channels(), 1);
  EXPECT_EQ(volume->minimum(), 0);
}

TEST(GridVolume, LightColoursAreInterpolatedAsSpectra) {
  VolumeFolder folder;
  const std::vector<float> values{.95f, .99f, .9f, .1f, .2f, .3f, .99f, .98f, .999f, 4, 3, 2};
  const VolumePtr volume =
      build_grid(write_bytes(folder.path() / "l.vol", make_vol({4, 1, 1}, 3, values).bytes()));
  const Wavelengths w = wavelengths();
  const auto voxel = [&](std::size_t i, int j) {
    const float *c = &values[3 * i], nm = w.nm[j];
    return (i < 3 ? upsample_srgb(c[0], c[1], c[2]) : upsample_unbounded(c[0], c[1], c[2])).at(nm);
  };
  for (std::size_t i = 0; i < 3; ++i)
    for (const float t : {0.f, .25f, .5f, .9f}) {
      const Spectrum v = volume->eval({(float(i) + .5f + t) / 4, .5f, .5f}, w);
      for (int j = 0; j < kWavelengths; ++j)
        EXPECT_NEAR(v[j], (1 - t) * voxel(i, j) + t * voxel(i + 1, j), 1e-5f) << i << " " << t;
    }
}

TEST(GridVolume, GreyColoursAreNumbers) {
  VolumeFolder folder;
  const VolumePtr volume =
      build_grid(write_bytes(folder.path() / "g.vol", make_vol({2, 1, 1}, 3, {3, 3, 3, 5, 5, 5}).bytes()));
  EXPECT_EQ(volume->eval({.5f, .5f, .5f}, wavelengths())[0], 4);
  EXPECT_EQ(volume->maximum(), 5);
}

TEST(GridVolume, NumbersThatAreNoColours) {
  VolumeFolder folder;
  const std::vector<float> values{1, 2, 3, -4, 5, 6, 3, 0, 1, 0, -5, 2};
  const VolumePtr six =
      build_grid(write_bytes(folder.path() / "6.vol", make_vol({2, 1, 1}, 6, values).bytes()));
  ASSERT_EQ(six->channels(), 6);
  float found[6];
  six->eval_channels({.5f, .5f, .5f}, found);
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(found[c], (values[c] + values[6 + c]) / 2);
  EXPECT_EQ(six->eval_scalar({.25f, .5f, .5f}), 1);
  EXPECT_EQ(six->minimum(), -5);
  const auto vectors = write_bytes(folder.path() / "3.vol", make_vol({4, 1, 1}, 3, values).bytes());
  EXPECT_EQ(build_grid(vectors, R"(<boolean name="raw" value="true"/>)")->channels(), 3);
  EXPECT_NE(error_thrown_by([&] { build_grid(vectors); }).find("a colour must not be negative"),
            std::string::npos);
}

TEST(GridVolume, VoxelsBelowZeroByRoundingAreZero) {
  VolumeFolder folder;
  for (const auto& [channels, values] : {std::pair{1, std::vector<float>{1, -1e-45f, -5e-7f, 0.5f}},
                                         {3, std::vector<float>{1, 0.5f, 0.25f, 0, -1e-45f, -5e-7f}}}) {
    const auto file = write_bytes(folder.path() / "a.vol",
                                  make_vol({int(values.size()) / channels, 1, 1}, channels, values).bytes());
    EXPECT_GE(build_grid(file)->minimum(), 0) << channels;
  }
  const auto file =
      write_bytes(folder.path() / "b.vol", make_vol({2, 1, 1}, 3, {1, 1, 1, 1, 1, -2e-6f}).bytes());
  EXPECT_NE(error_thrown_by([&] { build_grid(file); }).find("a colour must not be negative"),
            std::string::npos);
}

TEST(GridVolume, ValuesFromAProgram) {
  auto array =
      std::make_shared<Array>(std::vector<std::size_t>{1, 2, 3}, std::vector<double>{0, 1, 2, 3, 4, 5});
  const PluginInfo* plugin = Registry::instance().find("volume", "gridvolume");
  Properties p("gridvolume", "", {}, make_context(), plugin);
  p.add("data", ObjectPtr(array), {});
  const auto volume = std::dynamic_pointer_cast<const Volume>(plugin->create(p));
  EXPECT_EQ(volume->resolution(), (std::array<int, 3>{3, 2, 1}));
  EXPECT_EQ(volume->eval_scalar({.5f, .75f, .5f}), 4);
  Properties flat("gridvolume", "", {}, make_context(), plugin);
  flat.add("data",
           ObjectPtr(std::make_shared<Array>(std::vector<std::size_t>{2, 3},
                                             std::vector<double>{0, 1, 2, 3, 4, 5})),
           {});
  EXPECT_NE(error_thrown_by([&] { plugin->create(flat); }).find("got 2 x 3"), std::string::npos);
}

/// Every value in a part of the box is below its bound, whatever the filter, wrapping and transform.
TEST(GridVolume, BoundsHold) {
  VolumeFolder folder;
  SeededRandom random(11);
  const auto below = [&](int n) { return int(random.next() * float(n)); };
  const Wavelengths w = wavelengths(361, 67);
  for (int round = 0; round < 72; ++round) {
    const std::array<int, 3> n{1 + below(20), 1 + below(20), 1 + below(20)};
    const int channels = round % 2 ? 3 : 1;
    std::vector<float> values = noise(std::size_t(n[0] * n[1] * n[2] * channels), std::uint64_t(round));
    // Sharp peaks on nothing, which bricks of one value are made of.
    for (float& v : values) v = v > .9f ? 3 * v : 0;
    // Light colours, whose spectra are parts below white, beside black.
    if (round % 6 == 5)
      for (float& v : values) v = v > 0 ? 1 - .1f * v : round % 12 == 5 ? .98f : 0;
    const auto file = write_bytes(folder.path() / "b.vol", make_vol(n, channels, values).bytes());
    const std::string filter = round % 4 < 2 ? "trilinear" : "nearest";
    const std::string wrap = std::array{"clamp", "repeat", "mirror"}[std::size_t(round / 4 % 3)];
    const std::string far = round % 8 < 4 ? "0" : "300";
    const VolumePtr volume = build_grid(
        file,
        choice("filter_type", filter) + choice("wrap_mode", wrap) +
            R"(<transform name="to_world"><rotate x="1" y="2" z="3" angle="50"/><scale x="2" y="-1" z=".3"/>
                     <translate y=")" +
            far + R"("/></transform>)");
    const std::array<int, 3> cells{1 + below(9), 1 + below(9), 1 + below(9)};
    std::vector<float> bounds(std::size_t(cells[0] * cells[1] * cells[2]));
    volume->bound(cells, bounds);
    const Spectrum envelope = volume->envelope(w);
    const Transform from_box = volume->to_box()->inverse();
    float tightest = 0;
    for (int i = 0; i < 3000; ++i) {
      int cell[3];
      float p[3];
      for (std::size_t a = 0; a < 3; ++a) {
        cell[a] = below(cells[a]);
        const float in_cell = std::array{0.f, 1.f, random.next()}[std::size_t(below(3))];
        p[a] = (float(cell[a]) + in_cell) / float(cells[a]);
      }
      const float bound = bounds[std::size_t((cell[2] * cells[1] + cell[1]) * cells[0] + cell[0])];
      const Spectrum v = volume->eval(from_box.point({p[0], p[1], p[2]}), w);
      for (int j = 0; j < kWavelengths; ++j) {
        ASSERT_LE(v[j], bound * envelope[j]) << round << " " << filter << " " << wrap;
        tightest = std::max(tightest, v[j]);
      }
    }
    // They are no looser than the largest value.
    for (const float b : bounds) EXPECT_LE(b, volume->maximum() * 1.00001f);
    EXPECT_GT(tightest, 0);
  }
}

TEST(GridVolume, BoundsAreThoseOfTheirNeighbourhood) {
  VolumeFolder folder;
  std::vector<float> values(64 * 64 * 64);
  values[std::size_t((40 * 64 + 21) * 64 + 9)] = 2;
  const VolumePtr volume =
      build_grid(write_bytes(folder.path() / "p.vol", make_vol({64, 64, 64}, 1, values).bytes()));
  std::vector<float> bounds(16 * 16 * 16);
  volume->bound({16, 16, 16}, bounds);
  int above = 0;
  for (const float b : bounds) above += b > 0;
  // The peak's value spreads over 8.5 to 10.5 by 20.5 to 22.5 by 39.5 to 41.5 in voxels: of cells that are four
  // voxels wide one along x and y, and two along z.
  EXPECT_EQ(above, 2);
  EXPECT_NEAR(bounds[std::size_t((10 * 16 + 5) * 16 + 2)], 2, 1e-5);
}

std::string error_with(const VolFile& vol, const std::string& parameters = "") {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "bad.vol", vol.bytes());
  return error_thrown_by([&] { build_grid(file, parameters); });
}

TEST(GridVolume, BadFilesAreLocatedErrors) {
  const VolFile good = make_vol({2, 2, 2}, 1, std::vector<float>(8, 1.f));
  EXPECT_EQ(error_with(good), "");
  const auto expect = [&](auto&& change, const std::string& part) {
    VolFile bad = good;
    change(bad);
    const std::string message = error_with(bad);
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_NE(message.find("snippet:1"), std::string::npos) << message;
    EXPECT_NE(message.find("bad.vol"), std::string::npos) << message;
  };
  expect([](VolFile& v) { v.magic = "V\nL"; }, "begins with \"V\\x0aL\"");
  expect([](VolFile& v) { v.version = 2; }, "version 2");
  expect([](VolFile& v) { v.encoding = 4; }, "encoding 4");
  expect([](VolFile& v) { v.encoding = 77; }, "encoding 77");
  expect([](VolFile& v) { v.width = 0; }, "0 x 2 x 2");
  expect([](VolFile& v) { v.depth = -5; }, "2 x 2 x -5");
  expect([](VolFile& v) { v.height = 1 << 30; }, "each size lies in");
  expect([](VolFile& v) { v.width = v.height = v.depth = 1 << 20; }, "is truncated");
  expect([](VolFile& v) { v.data.pop_back(); }, "is truncated");
  expect([](VolFile& v) { v.channels = 0; }, "0 numbers");
  expect([](VolFile& v) { v.box[4] = 0; }, "along y from 0 to 0");
  expect([](VolFile& v) { v.box[0] = 3; }, "along x from 3 to 1");
  expect([](VolFile& v) { v.box[2] = NAN; }, "not finite");
  expect(
      [](VolFile& v) {
        v.set_data(std::vector<float>{1, 1, 1, 1, 1, 1, NAN, 1});
      },
      "holds nan at x = 0, y = 1, z = 1");
  VolFile two = make_vol({2, 2, 1}, 2, std::vector<float>(8, 1.f));
  EXPECT_NE(error_with(two).find("has 2 numbers at each voxel"), std::string::npos);
  EXPECT_NE(error_thrown_by([] { build_grid("/nowhere/a.vol"); }).find("no such file"), std::string::npos);
  VolumeFolder folder;
  const auto brief = write_bytes(folder.path() / "a.vol", "VOL\3");
  EXPECT_NE(error_thrown_by([&] { build_grid(brief); }).find("too short"), std::string::npos);
  EXPECT_NE(error_with(good, choice("filter_type", "cubic")).find("trilinear"), std::string::npos);
}

}  // namespace
}  // namespace aureole::test
