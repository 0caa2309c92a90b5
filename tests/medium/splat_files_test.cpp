// SPDX-License-Identifier: Apache-2.0
// Files of splats: what other programs read from them (tests/medium/data/make_splats.py), conventions, and files that are wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_cloud.h"
#include "aureole/parameter/splat/splat_writer.h"
#include "harness/paths.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

fs::path judged_folder() { return source_dir() / "tests/medium/data/splats"; }

std::vector<double> numbers_in(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<double>(in), {}};
}

SplatFileOptions as_stored() { return {.axes = "RUB"}; }

std::string message_of(const fs::path& file, const SplatFileOptions& options = {}) {
  try {
    read_splat_file(file, options);
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), file.string());
    return e.message();
  }
  return "";
}

TEST(Splat, FilesAreAsOtherProgramsReadThem) {
  std::ifstream in(source_dir() / "tests/medium/data/splats.txt");
  std::set<std::string> files;
  int lines = 0;
  std::map<std::string, SplatCloud> clouds;
  for (std::string line; std::getline(in, line); ++lines) {
    std::istringstream parts(line);
    std::string name, field;
    std::getline(parts, name, ';');
    std::vector<std::vector<double>> v;
    while (std::getline(parts, field, ';')) v.push_back(numbers_in(field));
    ASSERT_EQ(v.size(), 6u) << line;
    if (files.insert(name).second) clouds[name] = read_splat_file(judged_folder() / name, as_stored());
    const SplatCloud& c = clouds[name];
    const auto i = std::size_t(v[0][0]);
    ASSERT_EQ(c.size(), 12u) << name;
    SCOPED_TRACE(line);
    double turn = 0;
    for (std::size_t k = 0; k < 4; ++k) turn += v[3][k] * double(c.rotations[i][k]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(c.positions[i][k], v[1][std::size_t(k)], 1e-6 * (1 + std::abs(v[1][std::size_t(k)])));
      EXPECT_NEAR(c.scales[i][k], v[2][std::size_t(k)], 2e-6 * v[2][std::size_t(k)]);
    }
    EXPECT_NEAR(std::abs(turn), 1, 1e-6);  // q and -q are one rotation
    EXPECT_NEAR(c.opacities[i], v[4][0], 1e-6);
    ASSERT_EQ(v[5].size(), 3 * c.coefficients());
    for (std::size_t k = 0; k < v[5].size(); ++k) EXPECT_NEAR(c.harmonics_of(i)[k], v[5][k], 2e-6) << k;
  }
  EXPECT_EQ(lines, 360);
  EXPECT_EQ(files.size(), 18u);
}

TEST(Splat, ConstantsOfColours) {
  EXPECT_NEAR(kHarmonic0, 0.28209479, 2e-8);
  EXPECT_NEAR(0.5 / double(kHarmonic0), 1.7724539, 1e-6);  // f_dc of the colour 1
  float y[16];
  eval_harmonics(3, {0, 0, 1}, y);
  const float one[3] = {1.7724539f, 0, -1.7724539f};
  const Vec3 c = harmonic_color(one, y, 1);
  EXPECT_NEAR(c.x, 1, 1e-6);
  EXPECT_NEAR(c.y, 0.5, 1e-6);
  EXPECT_NEAR(c.z, 0, 1e-6);
}

TEST(Splat, HarmonicsAreOrthonormal) {
  // By a product rule that is exact for polynomials of degree 6: 8 nodes of Gauss and Legendre, 16 angles.
  const double nodes[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  const double weights[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  double sums[16][16] = {};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 16; ++j) {
      const double z = i < 4 ? nodes[i] : -nodes[i - 4], r = std::sqrt(1 - z * z),
                   phi = 2 * M_PI * (j + 0.5) / 16;
      float y[16];
      eval_harmonics(3, {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)}, y);
      for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b)
          sums[a][b] += weights[i % 4] * 2 * M_PI / 16 * double(y[a]) * double(y[b]);
    }
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < 16; ++b) EXPECT_NEAR(sums[a][b], a == b ? 1 : 0, 2e-6) << a << " " << b;
}

TEST(Splat, AxesAreTurned) {
  // The axes of a file are reversed in the cloud: positions, ellipsoids and colours by direction all are.
  const fs::path file = judged_folder() / "sh3.ply";
  const SplatCloud stored = read_splat_file(file, as_stored());
  for (const std::string& axes : splat_axes()) {
    const SplatCloud turned = read_splat_file(file, {.axes = axes});
    const Vec3 s{axes[0] == 'R' ? 1.f : -1.f, axes[1] == 'U' ? 1.f : -1.f, axes[2] == 'B' ? 1.f : -1.f};
    const auto squared_distance_of = [](const SplatCloud& c, std::size_t i, const Vec3& v) {
      const auto& q = c.rotations[i];
      const Vec3 u{-q[1], -q[2], -q[3]};  // by the inverse rotation
      const Vec3 t = 2.f * cross(u, v);
      const Vec3 local = v + q[0] * t + cross(u, t);
      const Vec3 by = c.scales[i];
      return length_squared({local.x / by.x, local.y / by.y, local.z / by.z});
    };
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (std::size_t i = 0; i < stored.size(); ++i) {
      const Vec3 v{normal(random), normal(random), normal(random)}, d = normalize(v);
      EXPECT_EQ(turned.positions[i], stored.positions[i] * s);
      const float expected = squared_distance_of(stored, i, v);
      EXPECT_NEAR(squared_distance_of(turned, i, v * s), expected, 2e-4f * expected) << axes;
      float y[16], z[16];
      eval_harmonics(3, d, y), eval_harmonics(3, d * s, z);
      const Vec3 a = harmonic_color(stored.harmonics_of(i), y, 16),
                 b = harmonic_color(turned.harmonics_of(i), z, 16);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 2e-6) << axes;
    }
  }
  EXPECT_EQ(read_splat_file(file).axes, "RDF");
  EXPECT_EQ(read_splat_file(judged_folder() / "sh3_v4.spz").axes, "RUB");
  EXPECT_EQ(read_splat_file(judged_folder() / "sh0.splat").axes, "RDF");
}

TEST(Splat, PlyInEveryEncoding) {
  const SplatFolder folder;
  std::vector<PlainSplat> splats(3);
  splats[1].position = {1, -2, 3}, splats[1].rotation = {2, 0, -2, 0}, splats[1].opacity = 0.25,
  splats[2].scale = {1, 2, 3};
  for (auto& s : splats) s.rest.assign(3, {0.25, -0.5, 0.125});
  for (const PlyKind kind : {PlyKind::little, PlyKind::big, PlyKind::ascii}) {
    const SplatCloud c = read_splat_file(folder.write("s.ply", make_ply(splats, kind)), as_stored());
    ASSERT_EQ(c.size(), 3u);
    EXPECT_EQ(c.degree, 1);
    EXPECT_EQ(c.positions[1], (Vec3{1, -2, 3}));
    EXPECT_NEAR(c.rotations[1][0], std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(c.rotations[1][2], -std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(c.opacities[1], 0.25, 1e-6);
    EXPECT_NEAR(c.scales[2].z, 3, 1e-5);
    EXPECT_EQ(c.harmonics_of(2)[3], 0.25f);
    EXPECT_EQ(c.harmonics_of(2)[4], -0.5f);
    EXPECT_EQ(c.harmonics_of(2)[11], 0.125f);
    EXPECT_TRUE(c.notes.empty()) << c.notes.front();
  }
}

TEST(Splat, NumbersThatAreWrong) {
  const SplatFolder folder;
  std::vector<PlainSplat> splats(6);
  splats[1].position[0] = NAN, splats[3].color[2] = INFINITY, splats[4].rotation = {0, 0, 0, 0};
  const SplatCloud c = read_splat_file(folder.write("nan.ply", make_ply(splats)));
  EXPECT_EQ(c.size(), 3u);
  ASSERT_EQ(c.notes.size(), 2u);
  EXPECT_EQ(
      c.notes[0],
      "has 2 of 6 splats with a number that is not finite, the first of them number 1: they are left out");
  EXPECT_EQ(
      c.notes[1],
      "has 1 splats whose rotation is the quaternion 0, which is none, the first of them number 2: they are left out");
  for (auto& s : splats) s.position[0] = NAN;
  EXPECT_EQ(
      message_of(folder.write("all.ply", make_ply(splats))),
      "has no splat that can be drawn: it has 6 of 6 splats with a number that is not finite, the first of them number 0: "
      "they are left out");

  std::string bytes = read_bytes(judged_folder() / "sh0.splat");
  const float negative = -0.5f;
  std::memcpy(&bytes[32 * 2 + 16], &negative, 4);
  EXPECT_NE(message_of(folder.write("negative.splat", bytes)).find("of splat 2; a scale is 0 or more"),
            std::string::npos);
  const float zero = 0;
  std::memcpy(&bytes[32 * 2 + 16], &zero, 4);
  const SplatCloud flat = read_splat_file(folder.write("zero.splat", bytes));
  EXPECT_EQ(flat.scales[2].y, 0);
  EXPECT_TRUE(flat.notes.empty());  // A disc has one scale of 0.
  for (int k = 0; k < 3; ++k) std::memcpy(&bytes[32 * 2 + 12 + 4 * std::size_t(k)], &zero, 4);
  EXPECT_EQ(read_splat_file(folder.write("zero.splat", bytes)).notes,
            std::vector<std::string>{
                "has 1 splats whose three scales are 0, the first of them number 2: they have no extent"});
}

TEST(Splat, CoefficientsThatMakeNoColour) {
  const SplatFolder folder;
  std::vector<PlainSplat> splats(4);
  for (PlainSplat& s : splats) s.rest.assign(3, {0.1, 0.2, -0.3});
  splats[1].rest[2][1] = -1e30;                               // a number of a damaged file
  splats[2].color = {2e6 * kPlainHarmonic0 + 0.5, 0.5, 0.5};  // twice the largest coefficient
  splats[3].rest[0][0] = 0.9e6;
  const SplatCloud c = read_splat_file(folder.write("bright.ply", make_ply(splats)));
  EXPECT_EQ(c.size(), 2u);
  EXPECT_EQ(
      c.notes,
      std::vector<std::string>{
          "has 2 splats with a coefficient of their colour beyond 1e+06, the first of them number 1: they "
          "are left out"});
  EXPECT_EQ(
      message_of(folder.write("none.ply", make_ply({splats[1]}))),
      "has no splat that can be drawn: it has 1 splats with a coefficient of their colour beyond 1e+06, the first of them "
      "number 0: they are left out");
}

TEST(Splat, FilesWithMoreThanTheirHeaderStates) {
  const SplatFolder folder;
  const auto notes_on = [&](const std::string& bytes) {
    return read_splat_file(folder.write("more.ply", bytes)).notes;
  };
  const std::vector<PlainSplat> splats(5);
  for (const PlyKind kind : {PlyKind::little, PlyKind::big, PlyKind::ascii}) {
    const std::string whole = make_ply(splats, kind);
    EXPECT_TRUE(notes_on(whole).empty());
    std::string fewer = whole;
    fewer.replace(fewer.find("vertex 5"), 8, "vertex 3");
    const auto notes = notes_on(fewer);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(notes[0],
              kind == PlyKind::ascii
                  ? "has lines behind the 3 vertices that its header states, which have no effect"
                  : "has 112 bytes behind the 3 vertices that its header states, which have no effect");
  }
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz"};
  const auto points =
      notes_on(make_ply(names, {{0, 0, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 0}, {2, 0, 0, NAN, 0, 1}}));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NE(points[1].find("has 2 of 3 points with a normal that is not finite or has no length"),
            std::string::npos);
}

/// Files that this program writes are those of the judged folder, of which splats.txt has the numbers that gsply and gaussforge read.
TEST(Splat, WrittenFilesAreThoseThatOtherProgramsRead) {
  const SplatFolder folder;
  for (const std::string name : {"sh0", "sh3"})
    for (const std::string extension : {".ply", ".spz"}) {
      const std::string written = "written_" + name + extension;
      write_splat_file(folder.path() / written, read_splat_file(judged_folder() / (name + ".ply")));
      if (const char* keep = std::getenv("AUREOLE_WRITTEN_SPLATS"))
        fs::copy_file(folder.path() / written, fs::path(keep) / written,
                      fs::copy_options::overwrite_existing);
      const SplatCloud a = read_splat_file(folder.path() / written),
                       b = read_splat_file(judged_folder() / written);
      ASSERT_EQ(a.size(), b.size());
      ASSERT_EQ(a.degree, b.degree);
      EXPECT_EQ(a.format, b.format);
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a.positions[i], b.positions[i]) << written;
        EXPECT_EQ(a.scales[i], b.scales[i]) << written;
        EXPECT_EQ(a.rotations[i], b.rotations[i]) << written;
        EXPECT_EQ(a.opacities[i], b.opacities[i]) << written;
      }
      EXPECT_TRUE(std::equal(a.harmonics.begin(), a.harmonics.end(), b.harmonics.begin(), b.harmonics.end()))
          << written;
    }
}

TEST(Splat, HarmonicsOfTheWrongLength) {
  const SplatFolder folder;
  const auto with_rest = [&](std::size_t rest) {
    auto names = splat_properties(0);
    std::vector<double> row = splat_numbers(PlainSplat());
    for (std::size_t k = 0; k < rest; ++k) names.push_back("f_rest_" + std::to_string(k)), row.push_back(0.1);
    return folder.write("rest.ply", make_ply(names, {row}));
  };
  for (const std::size_t n : {1u, 3u, 8u, 10u, 44u, 46u})
    EXPECT_EQ(
        message_of(with_rest(n)),
        "has " + std::to_string(n) +
            " properties f_rest_*; 0, 9, 24 or 45 are expected, for spherical harmonics of degree 0 to 3");
  EXPECT_EQ(read_splat_file(with_rest(24)).degree, 2);
  const SplatCloud four = read_splat_file(with_rest(72));
  EXPECT_EQ(four.degree, 3);
  EXPECT_EQ(four.notes,
            std::vector<std::string>{"has spherical harmonics of degree 4; those up to degree 3 are used"});
  auto names = splat_properties(3);
  names[6] = "f_rest_9";
  EXPECT_EQ(message_of(folder.write("gap.ply", make_ply(names, {std::vector<double>(names.size(), 0.1)}))),
            "has the property f_rest_1, but no f_rest_0");
  names = splat_properties(0);
  names[6] = "opacities";
  EXPECT_EQ(message_of(folder.write("name.ply", make_ply(names, {splat_numbers(PlainSplat())}))),
            "has vertices without the property \"opacity\", which a Gaussian splat needs");
  names[3] = "packed_position";
  EXPECT_NE(message_of(folder.write("packed.ply", make_ply(names, {splat_numbers(PlainSplat())})))
                .find("compressed PLY"),
            std::string::npos);
}

TEST(Splat, PointsWithNormalsAndRadii) {
  const SplatFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string full =
      header +
      "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\nproperty uchar "
      "red\nproperty uchar green\nproperty uchar blue\nproperty float quality\nend_header\n"
      "1 2 3 0 0 2 0.5 255 0 51 9\n4 5 6 -1 0 0 0.25 0 255 0 9\n";
  const SplatCloud c = read_splat_file(folder.write("points.ply", full), {.axes = "", .radius_scale = 2});
  EXPECT_EQ(c.kind, SplatCloud::Kind::points);
  EXPECT_TRUE(c.has_normals);
  EXPECT_EQ(c.positions[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(c.scales[0], (Vec3{1, 1, 0}));
  EXPECT_EQ(c.scales[1], (Vec3{0.5f, 0.5f, 0}));
  const auto& q = c.rotations[1];  // turns z to -x
  EXPECT_NEAR(2 * (q[1] * q[3] + q[0] * q[2]), -1, 1e-6);
  EXPECT_EQ(c.opacities[0], 1);
  EXPECT_NEAR(0.5f + kHarmonic0 * c.harmonics_of(0)[0], 1, 1e-6);
  EXPECT_NEAR(0.5f + kHarmonic0 * c.harmonics_of(0)[2], 0.2, 1e-6);
  EXPECT_EQ(c.notes, std::vector<std::string>{"has properties of its points that have no effect: quality"});
  EXPECT_EQ(c.hints.colors, SplatHints::Colors::srgb);

  const SplatCloud plain = read_splat_file(folder.write("plain.ply", header + "end_header\n1 2 3\n4 5 6\n"),
                                           {.axes = "", .radius = 0.125});
  EXPECT_EQ(plain.scales[0], (Vec3{0.125f, 0.125f, 0.125f}));
  EXPECT_EQ(plain.notes,
            std::vector<std::string>{"has points without colours (red, green, blue): they are white"});
}

/// A .glb with one primitive of two splats. `change` may damage it.
struct GlbText {
  std::string attributes =
      R"("POSITION":0,"KHR_gaussian_splatting:ROTATION":1,"KHR_gaussian_splatting:SCALE":2,)"
      R"("KHR_gaussian_splatting:OPACITY":3,"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0":4)";
  std::string extension = R"("kernel":"ellipse","colorSpace":"lin_rec709_display")";
  std::string node =
      R"("mesh":0,"translation":[10,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2])";
  std::string opacity_type = R"("componentType":5121,"normalized":true)";
  std::uint8_t opacities[2] = {51, 255};
  float scales[6] = {0.5f, 0.25f, 0.125f, 1, 1, 1};
  std::size_t binary_size = 0;  ///< 0: as it is

  std::string bytes() const {
    std::string binary;
    const auto add = [&](const auto& v) { binary.append(reinterpret_cast<const char*>(&v), sizeof v); };
    const float positions[6] = {1, 2, 3, 4, 5, 6}, rotations[8] = {0, 0, 0, 1, 1, 0, 0, 0},
                colors[6] = {0.5f, 0, -0.5f, 1, 1, 1};
    add(positions), add(rotations), add(scales), add(opacities);
    binary.append(2, '\0');
    add(colors);
    if (binary_size) binary.resize(binary_size);
    std::string json =
        R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_gaussian_splatting"],"scenes":[{"nodes":[0]}],"nodes":[{)" +
        node + R"(}],"meshes":[{"primitives":[{"mode":0,"attributes":{)" + attributes +
        R"(},"extensions":{"KHR_gaussian_splatting":{)" + extension +
        R"(}}}]}],"buffers":[{"byteLength":108}],)" +
        R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":24},{"buffer":0,"byteOffset":24,"byteLength":32},)" +
        R"({"buffer":0,"byteOffset":56,"byteLength":24},{"buffer":0,"byteOffset":80,"byteLength":2},)" +
        R"({"buffer":0,"byteOffset":84,"byteLength":24}],"accessors":[)";
    const char* types[] = {"VEC3", "VEC4", "VEC3", "SCALAR", "VEC3"};
    for (int i = 0; i < 5; ++i)
      json += std::string(i ? "," : "") + R"({"bufferView":)" + std::to_string(i) + R"(,"count":2,"type":")" +
              types[i] + "\"," + (i == 3 ? opacity_type : R"("componentType":5126)") + "}";
    json += "]}";
    while (json.size() % 4) json += ' ';
    std::string s = "glTF";
    const auto word = [&](std::uint32_t v) { s.append(reinterpret_cast<const char*>(&v), 4); };
    word(2), word(std::uint32_t(12 + 8 + json.size() + 8 + binary.size()));
    word(std::uint32_t(json.size())), word(0x4E4F534A), s += json;
    word(std::uint32_t(binary.size())), word(0x004E4942), s += binary;
    return s;
  }
};

TEST(Splat, GltfOfKhronos) {
  const SplatFolder folder;
  const SplatCloud c = read_splat_file(folder.write("a.glb", GlbText().bytes()));
  ASSERT_EQ(c.size(), 2u);
  // The node turns x to y, doubles and moves; scales are linear and rotations x, y, z, w.
  EXPECT_NEAR(c.positions[0].x, 10 - 4, 1e-5);
  EXPECT_NEAR(c.positions[0].y, 2, 1e-5);
  EXPECT_NEAR(c.positions[0].z, 6, 1e-5);
  EXPECT_NEAR(c.scales[0].x, 1, 1e-6);
  EXPECT_NEAR(c.scales[0].z, 0.25, 1e-6);
  EXPECT_NEAR(std::abs(c.rotations[0][0]), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(std::abs(c.rotations[0][3]), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(c.rotations[1][0], 0, 1e-6);
  EXPECT_NEAR(std::hypot(c.rotations[1][1], c.rotations[1][2]), 1, 1e-6);
  EXPECT_NEAR(c.opacities[0], 0.2, 1e-6);
  EXPECT_EQ(c.harmonics_of(0)[2], -0.5f);
  EXPECT_EQ(c.hints.colors, SplatHints::Colors::linear);
  EXPECT_EQ(c.hints.sorting, SplatHints::Sorting::camera_distance);
  EXPECT_EQ(c.hints.cutoff, 3);
  EXPECT_TRUE(c.notes.empty());

  const auto fault = [&](const std::function<void(GlbText&)>& change) {
    GlbText text;
    change(text);
    return message_of(folder.write("b.glb", text.bytes()));
  };
  EXPECT_NE(fault([](GlbText& t) { t.scales[4] = -1; }).find("a scale is 0 or more"), std::string::npos);
  EXPECT_NE(
      fault([](GlbText& t) { t.opacity_type = R"("componentType":5121)"; }).find("an opacity lies in [0, 1]"),
      std::string::npos);
  EXPECT_NE(
      fault([](GlbText& t) { t.node = R"("mesh":0,"scale":[1,2,1])"; }).find("scales its axes differently"),
      std::string::npos);
  EXPECT_NE(fault([](GlbText& t) { t.node = R"("mesh":0,"scale":[-1,1,1])"; }).find("mirrors"),
            std::string::npos);
  EXPECT_NE(fault([](GlbText& t) { t.node = R"("mesh":0,"children":[0])"; }).find("contain themselves"),
            std::string::npos);
  EXPECT_NE(fault([](GlbText& t) { t.binary_size = 90; }).find("is truncated"), std::string::npos);
  EXPECT_NE(fault([](GlbText& t) {
              t.attributes += R"(,"KHR_gaussian_splatting:SH_DEGREE_1_COEF_0":4)";
            }).find("has 1 of the 3 spherical harmonics of degree 1"),
            std::string::npos);
  EXPECT_NE(fault([](GlbText& t) {
              t.attributes = R"("POSITION":0)";
            }).find("without the attribute KHR_gaussian_splatting:"),
            std::string::npos);
  GlbText other;
  other.extension = R"("kernel":"customShape","sortingMethod":"byMood")";
  const SplatCloud noted = read_splat_file(folder.write("c.glb", other.bytes()));
  EXPECT_EQ(noted.notes,
            (std::vector<std::string>{
                "has the kernel \"customShape\", which is not known: ellipse is used",
                "has the sortingMethod \"byMood\", which is not known: cameraDistance is used"}));
}

TEST(Splat, FilesThatLie) {
  const SplatFolder folder;
  // Counts beyond the file allocate nothing.
  EXPECT_NE(message_of(folder.write("lie.ply", make_ply(splat_properties(0), {splat_numbers(PlainSplat())},
                                                        PlyKind::little, 1000000000)))
                .find("is truncated: 1000000000 vertices"),
            std::string::npos);
  std::string v4 = read_bytes(judged_folder() / "sh3_v4.spz");
  const auto patched = [&](std::size_t at, std::uint32_t value) {
    std::string s = v4;
    std::memcpy(&s[at], &value, 4);
    return folder.write("lie.spz", s);
  };
  EXPECT_NE(message_of(patched(8, 1 << 29)).find("bytes, decompressed; 536870912 splats need"),
            std::string::npos);
  EXPECT_NE(message_of(patched(8, 0xFFFFFFFF)).find("claims 4294967295 splats"), std::string::npos);
  EXPECT_NE(message_of(patched(4, 5)).find("has version 5 of the format .spz; 1 to 4 are known"),
            std::string::npos);
  EXPECT_NE(message_of(patched(16, 0xFFFFFF00)).find("table of lengths"), std::string::npos);
  EXPECT_NE(message_of(folder.write("part.splat", std::string(33, 'a'))).find("has 33 bytes"),
            std::string::npos);
  EXPECT_NE(message_of(folder.write("none.xyz", "hello")).find("is no file of splats that is known here"),
            std::string::npos);
}

/// Text of OpenUSD that usd-core has written from the numbers of PLY files (make_usd_splats.py).
TEST(Splat, OpenUsdHasTheNumbersOfThePly) {
  for (const auto& [usda, ply, half] :
       {std::tuple{"sh2.usda", "sh2.ply", false}, {"sh1_half.usda", "sh1.ply", true}}) {
    const SplatCloud a = read_splat_file(judged_folder() / usda),
                     b = read_splat_file(judged_folder() / ply, as_stored());
    EXPECT_EQ(a.notes, std::vector<std::string>());
    EXPECT_EQ(a.hints.sorting, SplatHints::Sorting::camera_distance);
    EXPECT_EQ(a.hints.projection, SplatHints::Projection::tangential);
    ASSERT_EQ(a.size(), b.size());
    ASSERT_EQ(a.degree, b.degree);
    const float relative = half ? 1e-3f : 1e-5f;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.positions[i][k], b.positions[i][k], relative * 4);
        EXPECT_NEAR(a.scales[i][k], b.scales[i][k], relative * b.scales[i][k]);
      }
      double turn = 0;
      for (std::size_t k = 0; k < 4; ++k) turn += double(a.rotations[i][k]) * double(b.rotations[i][k]);
      EXPECT_NEAR(std::abs(turn), 1, relative);
      EXPECT_NEAR(a.opacities[i], b.opacities[i], relative);
      for (std::size_t k = 0; k < 3 * a.coefficients(); ++k)
        EXPECT_NEAR(a.harmonics_of(i)[k], b.harmonics_of(i)[k], relative * 2);
    }
  }
}

TEST(Splat, OpenUsdText) {
  const SplatFolder folder;
  const auto read = [&](const std::string& text) { return read_splat_file(folder.write("t.usda", text)); };
  const std::string
      head = "#usda 1.0\n( upAxis = \"Z\" )\n",
      prim = "def ParticleField3DGaussianSplat \"S\" (\n customData = { string a = \"}\" }\n)\n{\n";
  const SplatCloud c = read(head + R"(def Xform "World" {
  double3 xformOp:translate = (0, 0, 0)
  uniform token[] xformOpOrder = ["xformOp:translate"]
)" + prim + R"(  # a comment }
  point3f[] positions = [(1, 2, 3), (4, 5, -6e0)] (doc = """long " ( text""")
  float3[] scales = [(1, 1, 1)]
  float[] opacities = [0.25, 0.5, 0.75]
  rel proxyPrim = </World/[x>
  float3[] radiance:sphericalHarmonicsCoefficients = [(1, 2, 3), (4, 5, 6)]
  uniform int radiance:sphericalHarmonicsDegree = 0
  uniform token visibility
}
)" + prim + "  point3f[] positions = [(7, 8, 9)]\n  token visibility = \"invisible\"\n}\n}\n");
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c.positions[1], (Vec3{4, 5, -6}));
  EXPECT_EQ(c.scales[1], (Vec3{1, 1, 1}));
  EXPECT_EQ(c.opacities[1], 0.5f);
  EXPECT_EQ(c.harmonics[5], 6);
  ASSERT_EQ(c.notes.size(), 4u);
  EXPECT_NE(c.notes[0].find("z axis up"), std::string::npos);
  EXPECT_NE(c.notes[1].find("invisible splats \"S\""), std::string::npos);
  EXPECT_NE(c.notes[2].find("3 numbers of scales for 2 splats, which is too few"), std::string::npos);
  EXPECT_NE(c.notes[3].find("3 numbers of opacities for 2 splats: those that are too many"),
            std::string::npos);

  const SplatCloud uneven = read("#usda 1.0\n" + prim +
                                 "point3f[] positions = [(1, 2, 3), (4, 5, 6)]\n"
                                 "quatf[] orientations = [(2, 0, 0, 2), (0.6, 0.8, 0, 0)]\n}\n");
  EXPECT_EQ(uneven.notes, std::vector<std::string>{
                              "has 1 splats whose rotation is no unit quaternion: they are normalised"});
  EXPECT_NEAR(uneven.rotations[0][3], std::sqrt(0.5), 1e-6);

  const auto fault = [&](const std::string& text) { return message_of(folder.write("t.usda", text)); };
  const struct {
    std::string text;
    const char* expected;
  } cases[] = {
      {"", "has no prim of the type ParticleField3DGaussianSplat"},
      {prim + "}\n", "the prims have no positions"},
      {prim + "point3f[] positions = [(1, 2)]\n}", "where a number is expected"},
      {prim + "point3f[] positions = [1, 2]\n}", "a tuple of 3 numbers is expected"},
      {prim + "point3f[] positions = [(1, 2, 3\n", "tuple that should have 3"},
      {prim + "point3f[] positions.timeSamples = { 0: [(1, 2, 3)] }\n}", "change with time"},
      {"def Xform \"W\" { float3 xformOp:scale = (2, 2, 2)\n}", "places its splats by"},
  };
  for (const auto& one : cases)
    EXPECT_NE(fault(head + one.text).find(one.expected), std::string::npos) << one.expected << "\n"
                                                                            << fault(head + one.text);
  std::string deep = head;
  for (int i = 0; i < 1000; ++i) deep += "def \"a\" {\n";
  EXPECT_NE(fault(deep).find("nested more than"), std::string::npos);
  EXPECT_NE(message_of(folder.write("t.usdc", "PXR-USDC....")).find("usdcat --flatten"), std::string::npos);
}

/// A written file, read by usd-core itself where that is installed.
TEST(Splat, OpenUsdReadsWhatIsWritten) {
  const char* python = std::getenv("AUREOLE_USD_PYTHON");
  if (!python)
    GTEST_SKIP()
        << "AUREOLE_USD_PYTHON names no Python with usd-core (pip install usd-core): OpenUSD does not judge";
  const SplatFolder folder;
  const SplatCloud from = read_splat_file(judged_folder() / "sh3.ply");
  const fs::path file = folder.path() / "out.usda", seen = folder.path() / "seen.txt";
  write_splat_file(file, from);
  const std::string command = std::string(python) + " " +
                              (source_dir() / "tests/medium/data/make_usd_splats.py").string() + " " +
                              file.string() + " > " + seen.string();
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  std::ifstream in(seen);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::vector<float> v(11 + 3 * from.coefficients());
    for (float& x : v) ASSERT_TRUE(in >> x);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(v[std::size_t(k)], from.positions[i][k]);
      EXPECT_EQ(v[std::size_t(7 + k)], from.scales[i][k]);
    }
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(v[3 + k], from.rotations[i][k]);
    EXPECT_EQ(v[10], from.opacities[i]);
    for (std::size_t k = 0; k < 3 * from.coefficients(); ++k) EXPECT_EQ(v[11 + k], from.harmonics_of(i)[k]);
  }
  std::string rest;
  EXPECT_FALSE(in >> rest);
}

/// Every file, truncated and with changed bytes, is a located error or a cloud of finite numbers.
TEST(Splat, DamagedFilesAreErrors) {
  const SplatFolder folder;
  std::vector<fs::path> files;
  for (const auto& e : fs::directory_iterator(judged_folder())) files.push_back(e.path());
  files.push_back(folder.write("seed.glb", GlbText().bytes()));
  std::sort(files.begin(), files.end());
  std::mt19937 random(11);
  int errors = 0, read = 0;
  const auto attempt = [&](const fs::path& from, const std::string& bytes) {
    const fs::path file = folder.write("damaged" + from.extension().string(), bytes);
    try {
      const SplatCloud c = read_splat_file(file);
      ++read;
      for (std::size_t i = 0; i < c.size(); ++i) {
        ASSERT_TRUE(is_finite(c.positions[i]) && c.opacities[i] >= 0 && c.opacities[i] <= 1);
        ASSERT_NEAR(std::hypot(std::hypot(c.rotations[i][0], c.rotations[i][1]),
                               std::hypot(c.rotations[i][2], c.rotations[i][3])),
                    1, 1e-3);
      }
    } catch (const Error& e) {
      ++errors;
      ASSERT_EQ(e.where().file.str(), file.string());
      ASSERT_FALSE(e.message().empty());
    }
  };
  for (const fs::path& from : files) {
    const std::string whole = read_bytes(from);
    for (int i = 0; i < 60; ++i) attempt(from, whole.substr(0, random() % whole.size()));
    for (int i = 0; i < 150; ++i) {
      std::string s = whole;
      for (unsigned k = 0; k <= random() % 4; ++k) s[random() % s.size()] = char(random());
      attempt(from, s);
    }
  }
  EXPECT_EQ(errors + read, int(files.size()) * 210);
  EXPECT_GT(errors, 1000);
}

}  // namespace
}  // namespace aureole::test
