// SPDX-License-Identifier: Apache-2.0
// Integrators that store AOVs, against closed forms: a ball and a plane before the sensor.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/render/job.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

constexpr int kSize = 24;

std::string scene_with(const std::string& integrator, const std::string& content,
                       const std::string& sampler = "sobol", int samples = 16, const std::string& film = "") {
  return R"(<scene version="3.0.0">)" + integrator +
         R"(<sensor type="perspective"><float name="fov" value="40"/><float name="near_clip" value="0.5"/>
    <transform name="to_world"><lookat origin="0, -5, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
    <sampler type=")" +
         sampler + R"("><integer name="sample_count" value=")" + std::to_string(samples) +
         R"("/></sampler><film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/>
    <string name="component_format" value="float32"/><rfilter type="box"/>)" +
         film + "</film></sensor>" + content + "</scene>";
}

const std::string kBallAndWall = R"(
<shape type="sphere"><float name="radius" value="1"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.7"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale x="2" y="3" z="1"/><rotate x="1" angle="90"/>
    <translate y="2"/></transform>
  <bsdf type="twosided"><bsdf type="diffuse"><float name="reflectance" value="0.9"/></bsdf></bsdf></shape>
<emitter type="constant"/>)";

RenderState rendered(const std::string& text, int replicates = 1) {
  RenderOptions options;
  options.replicates = replicates;
  RenderJob job(load_scene_from_string(text, "aov.xml"), options);
  const std::atomic<bool> go{false};
  job.run(go);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state();
}

Image picture(const std::string& text) { return rendered(text).picture(); }

float value(const Image& image, const std::string& channel, int x, int y) {
  EXPECT_GE(image.channel(channel), 0) << channel;
  return image.at(x, y, size_t(image.channel(channel)));
}

/// The ray through a pixel's centre: its origin is the pinhole.
Vec3 direction(int x, int y) {
  const float half = std::tan(20 * kPi / 180);
  // The first pixel is on the left and on top; +x of the world is on the right here.
  return normalize(
      Vec3{(2 * (float(x) + 0.5f) / kSize - 1) * half, 1, (1 - 2 * (float(y) + 0.5f) / kSize) * half});
}

TEST(Aov, ShowsWhatTheSensorMeets) {
  const Image image = picture(scene_with(
      R"(<integrator type="aov"><string name="aovs" value="a:albedo,dd.y:depth, p:position, uv:uv,n:geo_normal,s:sh_normal,du:dp_du,dv:dp_dv,i:prim_index,j:shape_index"/></integrator>)",
      kBallAndWall));
  int balls = 0, walls = 0, misses = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      SCOPED_TRACE(::testing::Message() << x << " " << y);
      EXPECT_EQ(value(image, "R", x, y), 0.f) << "no picture without a nested integrator";
      const Vec3 o{0, -5, 0}, d = direction(x, y);
      // Skip pixels that an outline crosses; inside, a mean over the pixel differs from the value at its
      // centre by the curvature only.
      const float b = dot(o, d), miss2 = 25 - b * b;
      const Vec3 on_wall = o + d * (7 / d.y);
      const bool wall = std::abs(on_wall.x) < 1.8f && std::abs(on_wall.z) < 2.8f;
      const bool near_edge =
          std::abs(std::abs(on_wall.x) - 2) < 0.3f || std::abs(std::abs(on_wall.z) - 3) < 0.3f;
      Vec3 p, n;
      float depth;
      if (std::sqrt(miss2) < 0.85f) {
        depth = -b - std::sqrt(1 - miss2);
        n = p = o + d * depth;
        ++balls;
        EXPECT_NEAR(value(image, "j.I", x, y), 1, 1e-6);
        EXPECT_NEAR(value(image, "a.R", x, y), 0.2, 0.03);
        EXPECT_NEAR(value(image, "a.G", x, y), 0.5, 0.03);
        EXPECT_NEAR(value(image, "a.B", x, y), 0.7, 0.03);
        const float theta = std::acos(n.z);
        float phi = std::atan2(n.y, n.x);
        if (phi < 0) phi += 2 * kPi;
        EXPECT_NEAR(value(image, "uv.U", x, y), phi / (2 * kPi), 0.01);
        EXPECT_NEAR(value(image, "uv.V", x, y), theta / kPi, 0.01);
        EXPECT_NEAR(value(image, "du.X", x, y), -2 * kPi * n.y, 0.1);
        EXPECT_NEAR(value(image, "du.Y", x, y), 2 * kPi * n.x, 0.1);
        EXPECT_NEAR(value(image, "dv.Z", x, y), -kPi * std::sin(theta), 0.1);
      } else if (std::sqrt(miss2) > 1.15f && wall) {
        p = on_wall, n = {0, -1, 0}, depth = 7 / d.y;
        ++walls;
        EXPECT_NEAR(value(image, "j.I", x, y), 2, 1e-6);
        for (const char* c : {"a.R", "a.G", "a.B"}) EXPECT_NEAR(value(image, c, x, y), 0.9, 3e-4);
        EXPECT_NEAR(value(image, "uv.U", x, y), p.x / 4 + 0.5f, 0.01);
        EXPECT_NEAR(value(image, "uv.V", x, y), p.z / 6 + 0.5f, 0.01);
        EXPECT_NEAR(value(image, "du.X", x, y), 4, 1e-5);
        EXPECT_NEAR(value(image, "dv.Z", x, y), 6, 1e-5);
      } else if (std::sqrt(miss2) > 1.15f && !near_edge) {
        ++misses;
        for (const auto& name : image.channels) EXPECT_EQ(value(image, name, x, y), 0.f) << name;
        continue;
      } else {
        continue;
      }
      EXPECT_NEAR(value(image, "dd.y.T", x, y), depth - 0.5f / d.y, 0.02) << "from the near plane";
      const char* axes[] = {"X", "Y", "Z"};
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(value(image, std::string("p.") + axes[c], x, y), p[c], 0.02);
        EXPECT_NEAR(value(image, std::string("n.") + axes[c], x, y), n[c], 0.02);
        EXPECT_NEAR(value(image, std::string("s.") + axes[c], x, y), n[c], 0.02);
      }
    }
  EXPECT_GT(balls, 40);
  EXPECT_GT(walls, 100);
  EXPECT_GT(misses, 20);
}

TEST(Aov, NestedIntegratorsKeepTheirPictures) {
  const Image plain = picture(scene_with(R"(<integrator type="path"/>)", kBallAndWall));
  const Image image = picture(scene_with(
      R"(<integrator type="aov"><string name="aovs" value="d:depth"/><integrator type="path" name="img"/>
         <integrator type="depth"/><integrator type="aov"><string name="aovs" value="n:sh_normal"/></integrator></integrator>)",
      kBallAndWall, "sobol", 16, R"(<string name="pixel_format" value="rgba"/>)"));
  const std::vector<std::string> names = {"R",          "G",          "B",          "img.R",    "img.G",
                                          "img.B",      "img.A",      "_arg_0.R",   "_arg_0.G", "_arg_0.B",
                                          "_arg_0.A",   "_arg_1.R",   "_arg_1.G",   "_arg_1.B", "_arg_1.A",
                                          "_arg_1.n.X", "_arg_1.n.Y", "_arg_1.n.Z", "d.T",      "A"};
  EXPECT_EQ(image.channels, names);
  double depth_x = 0, depth_y = 0, normals = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      for (const char* c : {"R", "G", "B"}) {
        EXPECT_FLOAT_EQ(value(image, c, x, y), value(plain, c, x, y));
        EXPECT_NEAR(value(image, std::string("img.") + c, x, y), value(plain, c, x, y), 1e-4);
      }
      EXPECT_FLOAT_EQ(value(image, "img.A", x, y), 1) << "the environment counts as seen";
      depth_x += value(image, "d.T", x, y);
      // Y of a flat spectrum from its sRGB.
      depth_y += 0.2126729 * value(image, "_arg_0.R", x, y) + 0.7151522 * value(image, "_arg_0.G", x, y) +
                 0.0721750 * value(image, "_arg_0.B", x, y);
      normals += std::abs(value(image, "_arg_1.n.Y", x, y));
    }
  EXPECT_NEAR(depth_y, depth_x, 2e-3 * depth_x);
  EXPECT_GT(normals, 100);
}

TEST(Depth, IsTheLuminanceOfAFlatSpectrum) {
  const Image image = picture(scene_with(R"(<integrator type="depth"/>)", kBallAndWall, "sobol", 64,
                                         R"(<string name="pixel_format" value="luminance_alpha"/>)"));
  EXPECT_NEAR(value(image, "Y", 12, 12), 4 - 0.5, 0.02);
  EXPECT_NEAR(value(image, "A", 12, 12), 1, 1e-6);
  EXPECT_EQ(value(image, "Y", 0, 12), 0.f);
  EXPECT_EQ(value(image, "A", 0, 12), 0.f);
}

// A mirror before the sensor shows a wall behind it, a pane the ball behind it.
TEST(Aov, FollowsMirrorsAndPanes) {
  const auto with = [](int depth, const std::string& content) {
    return picture(
        scene_with(R"(<integrator type="aov"><string name="aovs" value="a:albedo,d.y:depth,n:sh_normal"/>
        <integer name="specular_depth" value=")" +
                       std::to_string(depth) + "\"/></integrator>",
                   content, "sobol", 256));
  };
  const std::string mirror = R"(
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="90"/></transform>
  <bsdf type="twosided"><bsdf type="conductor"><string name="material" value="none"/></bsdf></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="9"/><rotate x="1" angle="90"/><translate y="-8"/></transform>
  <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.7"/></bsdf></bsdf></shape>)";
  const Image front = with(0, mirror), behind = with(1, mirror);
  EXPECT_EQ(value(front, "a.G", 12, 12), 0.f);
  EXPECT_NEAR(value(front, "d.y.T", 12, 12), 5 - 0.5, 0.01);
  EXPECT_NEAR(value(behind, "a.R", 12, 12), 0.2, 2e-3);
  EXPECT_NEAR(value(behind, "a.G", 12, 12), 0.5, 2e-3);
  EXPECT_NEAR(value(behind, "d.y.T", 12, 12), 5 + 8 - 0.5, 0.02);
  EXPECT_NEAR(std::abs(value(behind, "n.Y", 12, 12)), 1, 1e-5);
  const std::string pane = R"(
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="90"/><translate y="-2"/></transform>
  <bsdf type="thindielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>)" +
                           kBallAndWall;
  // Two surfaces of an index of 1.5 transmit 2 n/(n^2 + 1), and nothing lies where they reflect.
  constexpr double kTransmitted = 2 * 1.5 / (1.5 * 1.5 + 1);
  EXPECT_NEAR(value(with(2, pane), "a.G", 12, 12), 0.5 * kTransmitted, 0.01);
}

// In a band outside the visible, colours are the band's mean: the reflectance itself.
TEST(Aov, OutsideTheVisibleColoursAreMeans) {
  const Image image = picture(scene_with(
      R"(<integrator type="aov"><string name="aovs" value="a:albedo"/></integrator>)", kBallAndWall, "sobol",
      16,
      R"(<string name="wavelength_min" value="1000nm"/><string name="wavelength_max" value="1100nm"/>
                    <string name="response" value="uniform"/>)"));
  for (const char* c : {"a.R", "a.G", "a.B"}) EXPECT_NEAR(value(image, c, 12, 1), 0.9, 1e-4);
}

// m2 - mean^2 is the variance of one sample; over their number it is the variance between renders.
TEST(Moment, PredictsTheVarianceBetweenSeeds) {
  constexpr int kSamples = 16, kReplicates = 64;
  const RenderState state = rendered(
      scene_with(
          R"(<integrator type="moment"><integrator type="path" name="img"><integer name="max_depth" value="3"/></integrator></integrator>)",
          kBallAndWall, "independent", kSamples),
      kReplicates);
  const Image image = state.picture();
  const std::vector<std::string> names = {"R",     "G",        "B",        "img.X",   "img.Y",
                                          "img.Z", "m2_img.X", "m2_img.Y", "m2_img.Z"};
  EXPECT_EQ(std::vector<std::string>(image.channels.begin(), image.channels.begin() + 9), names);
  for (const std::string axis : {"X", "Y", "Z"}) {
    double predicted = 0, found = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double mean = value(image, "img." + axis, x, y);
        // The mean's own error makes mean^2 too large.
        const double variance = value(image, "variance.img." + axis, x, y);
        predicted += value(image, "m2_img." + axis, x, y) - mean * mean + variance;
        found += variance * kReplicates * kSamples;
      }
    // 576 variances with 63 degrees of freedom: .7 % for normal samples, more for heavy tails.
    EXPECT_NEAR(found / predicted, 1, 0.04) << axis;
    EXPECT_GT(predicted, 0);
  }
}

TEST(Channels, WrongInputIsLocated) {
  const auto errors = [](const std::string& integrator) {
    const auto list = errors_of_file(scene_with(integrator, kBallAndWall));
    EXPECT_EQ(list.size(), 1u) << ::testing::PrintToString(list);
    return list.empty() ? "" : list.front();
  };
  const auto aov = [&](const std::string& text) {
    return errors(R"(<integrator type="aov"><string name="aovs" value=")" + text + "\"/></integrator>");
  };
  EXPECT_NE(aov("a:albdo").find("did you mean \"albedo\""), std::string::npos) << aov("a:albdo");
  EXPECT_NE(aov("depth").find("NAME:TYPE"), std::string::npos) << aov("depth");
  EXPECT_NE(aov(":depth").find("NAME:TYPE"), std::string::npos);
  EXPECT_NE(aov("a:depth:b").find("NAME:TYPE"), std::string::npos);
  EXPECT_NE(aov("").find("names no channel"), std::string::npos);
  EXPECT_NE(aov("a:depth,a:depth").find("\"a.T\""), std::string::npos);
  EXPECT_NE(aov("a:duv_dx").find("duv_dx"), std::string::npos);
  EXPECT_NE(errors(R"(<integrator type="aov"/>)").find("\"aovs\""), std::string::npos);
  EXPECT_NE(errors(R"(<integrator type="moment"/>)").find("nested integrator"), std::string::npos);
  EXPECT_NE(
      errors(R"(<integrator type="moment"><integrator type="ptracer"/></integrator>)").find("light paths"),
      std::string::npos);
}

}  // namespace
}  // namespace aureole::test
